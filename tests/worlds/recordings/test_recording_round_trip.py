import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from worlds.recordings.files import read_recording, write_recording
from worlds.recordings.metadata import RecordingMetadata, ServoGains
from worlds.recordings.recording import Recording

METADATA = RecordingMetadata(
    "nao", "floating", "a test", servo={"knee": ServoGains(20.0, 1.5, 9.0)}
)
METADATA_OF_A = RecordingMetadata("arm", "fixed", "a test")
SUFFIXES = [".parquet", ".csv"]


def recording():
    time_s = np.array([0.0, 0.01, 0.03])
    knee = np.array([0.1, np.nan, -0.0])
    return Recording(
        {"time": time_s, "position.knee": knee, "command.knee": knee + 1.0}, METADATA
    )


def assert_same_bits(left, right):
    """The same numbers bit by bit, and the same ones missing."""
    assert list(left.columns) == list(right.columns)
    for name, values in left.columns.items():
        other = right.columns[name]
        np.testing.assert_array_equal(np.isnan(values), np.isnan(other))
        there = ~np.isnan(values)
        np.testing.assert_array_equal(
            values[there].view(np.int64), other[there].view(np.int64)
        )
    assert left.metadata == right.metadata


FINITE = st.floats(allow_nan=False, allow_infinity=False)
MAYBE = st.one_of(FINITE, st.just(float("nan")))
JOINTS = st.lists(
    st.text(min_size=1, max_size=8).filter(str.isprintable),
    min_size=1,
    max_size=4,
    unique=True,
)


@st.composite
def recordings(draw):
    time_s = sorted(draw(st.sets(FINITE, min_size=1, max_size=12)))
    values = st.lists(MAYBE, min_size=len(time_s), max_size=len(time_s))
    columns = {"time": time_s}
    for joint in draw(JOINTS):
        columns[f"position.{joint}"] = draw(values)
        columns[f"command.{joint}"] = draw(values)
    for axis in "xyz":
        columns[f"gyroscope.{axis}"] = draw(values)
    gait = draw(st.none() | st.dictionaries(st.text(max_size=5), FINITE, max_size=3))
    return Recording(columns, RecordingMetadata("nao", "fixed", "", gait=gait))


@pytest.mark.parametrize("suffix", SUFFIXES)
@given(original=recordings())
@settings(max_examples=60, deadline=None)
def test_reading_gives_back_every_bit(suffix, original, tmp_path_factory):
    path = tmp_path_factory.mktemp("trip") / f"rollout{suffix}"
    write_recording(original, path)
    assert_same_bits(read_recording(path), original)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_hard_numbers_survive(suffix, tmp_path):
    hard = np.array(
        [-0.0, 0.0, 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, 0.1, 1 / 3]
    )
    columns = {"time": np.arange(7.0), "position.a": hard, "torque.a": -hard}
    original = Recording(columns, METADATA_OF_A)
    path = tmp_path / f"hard{suffix}"
    write_recording(original, path)
    assert_same_bits(read_recording(path), original)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_many_blocks_and_row_groups_keep_their_order(suffix, tmp_path):
    rng = np.random.default_rng(3)
    rows = 60_000  # 3 MB of CSV; it is read in blocks of 1 MB
    columns = {"time": np.cumsum(rng.random(rows) + 1e-3)}
    columns |= {f"{kind}.a": rng.normal(size=rows) for kind in ("position", "torque")}
    original = Recording(columns, METADATA_OF_A)
    path = tmp_path / f"long{suffix}"
    write_recording(original, path)
    assert_same_bits(read_recording(path), original)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_the_same_recording_gives_the_same_bytes(suffix, tmp_path):
    first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
    write_recording(recording(), first)
    write_recording(read_recording(first), second)
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 0


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_nothing_else_is_left_in_the_folder(suffix, tmp_path):
    write_recording(recording(), tmp_path / f"a{suffix}")
    expected = {"a.parquet"} if suffix == ".parquet" else {"a.csv", "a.json"}
    assert {path.name for path in tmp_path.iterdir()} == expected


def test_capital_suffixes_are_fine(tmp_path):
    path = tmp_path / "A.CSV"
    write_recording(recording(), path)
    assert_same_bits(read_recording(path), recording())


def test_the_parquet_file_is_what_the_format_says(tmp_path):
    path = tmp_path / "a.parquet"
    write_recording(recording(), path)
    there = pq.read_table(path)
    assert there.column_names == ["time", "position.knee", "command.knee"]
    assert there["position.knee"].to_pylist() == [0.1, None, -0.0]
    assert json.loads(there.schema.metadata[b"groundwalk"]) == {
        "format": 1,
        "robot": "nao",
        "base": "floating",
        "source": "a test",
        "servo": {"knee": {"kp": 20.0, "kd": 1.5, "max_torque": 9.0}},
    }


def test_the_csv_file_is_what_the_format_says(tmp_path):
    path = tmp_path / "a.csv"
    write_recording(recording(), path)
    assert path.read_text().replace('"', "") == (
        "time,position.knee,command.knee\n0,0.1,1.1\n0.01,,\n0.03,-0,1\n"
    )
    assert json.loads((tmp_path / "a.json").read_text())["robot"] == "nao"
