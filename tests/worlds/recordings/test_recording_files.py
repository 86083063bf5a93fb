import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from groundwalk.errors import BadRecordingError
from worlds.recordings.files import read_recording
from worlds.recordings.metadata import RecordingMetadata, ServoGains

METADATA = RecordingMetadata("nao", "floating", "an argument")
JSON = '{"format": 1, "robot": "arm.xml", "base": "fixed", "source": "by hand"}'
BY_HAND = RecordingMetadata("arm.xml", "fixed", "by hand")
HEADER = "time,position.knee,command.knee\n"


def refusal(path, metadata=None):
    with pytest.raises(BadRecordingError) as caught:
        read_recording(path, metadata)
    message = str(caught.value)
    assert "\n" not in message
    return message


def csv_file(folder, rows, header=HEADER, metadata=JSON):
    path = folder / "hand.csv"
    path.write_bytes((header + rows).encode())
    if metadata is not None:
        path.with_suffix(".json").write_text(metadata)
    return path


def parquet_file(folder, table, metadata=JSON):
    path = folder / "other.parquet"
    keys = None if metadata is None else {"groundwalk": metadata}
    pq.write_table(table.replace_schema_metadata(keys), path)
    return path


def table(**changed):
    columns = {"time": [0.0, 0.5], "position.knee": [1.0, 2.0], "command.knee": [3, 4]}
    return pa.table(columns | {key.replace("__", "."): changed[key] for key in changed})


def test_a_csv_file_written_by_hand(tmp_path):
    path = csv_file(tmp_path, '0,1e-1,\r\n\r\n"2",nan,-3', header="\ufeff" + HEADER)
    read = read_recording(path)
    np.testing.assert_array_equal(read.time_s, [0.0, 2.0])
    np.testing.assert_array_equal(
        read.joint_values("position", ["knee"]), [[0.1], [np.nan]]
    )
    np.testing.assert_array_equal(
        read.joint_values("command", ["knee"]), [[np.nan], [-3.0]]
    )
    assert read.metadata == BY_HAND


def test_a_good_parquet_file_of_another_program(tmp_path):
    read = read_recording(parquet_file(tmp_path, table()))
    np.testing.assert_array_equal(
        read.joint_values("command", ["knee"]), [[3.0], [4.0]]
    )
    assert read.metadata == BY_HAND


def test_a_parquet_file_with_other_kinds_of_numbers(tmp_path):
    other = table(
        position__knee=pa.array([0.5, None], pa.float32()),
        command__knee=pa.array([2**60 + 1, None], pa.int64()),
        velocity__knee=pa.nulls(2),
        torque__knee=pa.array(["1.25", "2.50"]).cast(pa.decimal128(5, 2)),
    )
    read = read_recording(parquet_file(tmp_path, other))
    np.testing.assert_array_equal(
        read.joint_values("position", ["knee"]), [[0.5], [np.nan]]
    )
    np.testing.assert_array_equal(
        read.joint_values("command", ["knee"]), [[2.0**60], [np.nan]]
    )
    np.testing.assert_array_equal(
        read.joint_values("velocity", ["knee"]), [[np.nan], [np.nan]]
    )
    np.testing.assert_array_equal(
        read.joint_values("torque", ["knee"]), [[1.25], [2.5]]
    )


def test_an_argument_stands_in_for_missing_metadata(tmp_path):
    path = csv_file(tmp_path, "0,1,2\n", metadata=None)
    assert read_recording(path, METADATA).metadata == METADATA
    path = parquet_file(tmp_path, table(), metadata=None)
    assert read_recording(path, METADATA).metadata == METADATA


def test_an_argument_goes_before_the_metadata_of_the_file(tmp_path):
    path = csv_file(tmp_path, "0,1,2\n", metadata="{broken")
    assert read_recording(path, METADATA).metadata == METADATA
    path = parquet_file(tmp_path, table(), metadata="{broken")
    assert read_recording(path, METADATA).metadata == METADATA


def test_a_csv_file_without_metadata_says_what_to_do(tmp_path):
    path = csv_file(tmp_path, "0,1,2\n", metadata=None)
    message = refusal(path)
    assert message.startswith(f"{path}: ")
    assert "write hand.json beside it" in message
    assert "or give the metadata as an argument" in message
    example = message[message.index("{") : message.index("}") + 1]
    path.with_suffix(".json").write_text(example)
    assert read_recording(path).metadata.robot == "nao"


def test_a_parquet_file_without_metadata_says_what_to_do(tmp_path):
    path = parquet_file(tmp_path, table(), metadata=None)
    assert f"{path}: no metadata under the key 'groundwalk'" in refusal(path)


def test_wrong_metadata_are_blamed_on_their_own_file(tmp_path):
    path = csv_file(tmp_path, "0,1,2\n", metadata="{broken")
    assert f"{path.with_suffix('.json')}: metadata is not JSON" in refusal(path)
    path = parquet_file(tmp_path, table(), metadata="{broken")
    assert f"{path}: metadata is not JSON" in refusal(path)


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_a_servo_for_no_joint_is_found(suffix, tmp_path):
    if suffix == ".csv":
        path = csv_file(tmp_path, "0,1,2\n")
    else:
        path = parquet_file(tmp_path, table())
    servo = {"nee": ServoGains(1.0, 1.0, 1.0)}
    wrong = RecordingMetadata("nao", "fixed", "", servo=servo)
    assert f"{path}: metadata has a servo for 'nee'" in refusal(path, wrong)


@pytest.mark.parametrize(
    ("rows", "problem"),
    [
        ("0,1,2\n1,x1,3\n", "column 'position.knee', row 1 (counted from 0): 'x1' is"),
        ("0,1,2\n\n\n1,2,1_0\n", "column 'command.knee', row 1 "),
        ("0,1,2\n1,2,3\n2,3,inf\n", "column 'command.knee', row 2 "),
        ("0,1,2\n1,2,1e999\n", "column 'command.knee', row 1 "),
        ("0,1,2\n,2,3\n", "column 'time', row 1 (counted from 0): a time is missing"),
        ("0,1,2\n1,2,3\n1,3,4\n", "column 'time', row 2 "),
        ("0,1,2\n1,2\n", "row 1 (counted from 0) has 2 cells, the header has 3"),
        ("0,1,2\n\n1,2,3,4\n", "row 1 (counted from 0) has 4 cells, the header has 3"),
        ("", "no rows"),
    ],
)
def test_wrong_rows_of_csv(rows, problem, tmp_path):
    path = csv_file(tmp_path, rows)
    assert refusal(path).startswith(f"{path}: {problem}")


def test_a_wrong_cell_far_down(tmp_path):
    rows = "".join(f"{k},{k / 7},1\n" for k in range(80_000))
    path = csv_file(tmp_path, rows + "80000,1,oops\n")
    assert "column 'command.knee', row 80000 " in refusal(path)
    path = csv_file(tmp_path, rows + "80000,1\n")
    assert "row 80000 (counted from 0) has 2 cells" in refusal(path)


@pytest.mark.parametrize(
    ("header", "problem"),
    [
        (
            HEADER.replace("knee,c", "knee,position.knee,c"),
            "'position.knee' is there 2",
        ),
        (HEADER.replace("position", "positon"), "did you mean 'position.knee'?"),
        (HEADER.replace(",", ";"), "its columns are separated by ';'; a recording has"),
        (HEADER.replace(",", "\t"), r"its columns are separated by '\t'"),
        ("\n" + HEADER, "no column 'time'"),
        ("time,position.knee\n", "no column says what drove the joints"),
        (HEADER.strip() + ",gyroscope.x\n", "'gyroscope.y' is missing"),
    ],
)
def test_wrong_headers_of_csv(header, problem, tmp_path):
    path = csv_file(tmp_path, "0,1,2\n", header=header)
    message = refusal(path)
    assert message.startswith(f"{path}: ")
    assert problem in message


@pytest.mark.parametrize("encoding", ["utf-16", "latin-1"])
def test_csv_in_another_encoding(encoding, tmp_path):
    path = tmp_path / "a.csv"
    path.write_bytes(HEADER.replace("knee", "käfer").encode(encoding))
    assert f"{path}: cannot be read as CSV: " in refusal(path)


def test_csv_with_bytes_that_are_no_text(tmp_path):
    path = csv_file(tmp_path, "0,1,2\n" * 5_000)
    path.write_bytes(path.read_bytes() + b"1,2,\xff\n")
    assert f"{path}: cannot be read as CSV: " in refusal(path)


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"position__knee": ["1", "2"]}, "column 'position.knee' holds string, not nu"),
        ({"position__knee": [True, False]}, "column 'position.knee' holds bool, not n"),
        ({"position__knee": [[1.0], [2.0]]}, "column 'position.knee' holds list<"),
        ({"time": pa.array([0, 1], pa.timestamp("ns"))}, "column 'time' holds timest"),
        ({"time": [0.0, 0.0]}, "column 'time', row 1 (counted from 0): 0.0 s is not l"),
        ({"time": [0.0, None]}, "column 'time', row 1 (counted from 0): a time is mis"),
        ({"command__knee": [0.0, np.inf]}, "column 'command.knee', row 1 "),
        ({"support": [0, 2]}, "column 'support', row 1 "),
        ({"comand__knee": [0, 2]}, "unknown column 'comand.knee'; did you mean 'comm"),
        ({"base__position__x": [0, 2]}, "column 'base.position.y' is missing"),
    ],
)
def test_wrong_columns_of_parquet(changed, problem, tmp_path):
    path = parquet_file(tmp_path, table(**changed))
    assert refusal(path).startswith(f"{path}: {problem}")


def test_a_parquet_file_with_a_column_twice(tmp_path):
    twice = table().append_column("time", pa.array([0.0, 1.0]))
    path = parquet_file(tmp_path, twice)
    assert refusal(path) == f"{path}: column 'time' is there 2 times"


def test_a_parquet_file_without_rows(tmp_path):
    path = parquet_file(tmp_path, table().slice(0, 0))
    assert refusal(path) == f"{path}: no rows"
