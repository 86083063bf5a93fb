import numpy as np
import pyarrow.parquet as pq
import pytest

from groundwalk.errors import BadRecordingError
from worlds.recordings.files import read_recording, write_recording
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording

METADATA = RecordingMetadata("nao", "floating", "a test")
SUFFIXES = [".parquet", ".csv"]


def recording():
    time_s = np.array([0.0, 0.01, 0.03])
    knee = np.array([0.1, np.nan, -0.0])
    return Recording(
        {"time": time_s, "position.knee": knee, "command.knee": knee + 1.0}, METADATA
    )


def refusal(path, metadata=None):
    with pytest.raises(BadRecordingError) as caught:
        read_recording(path, metadata)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_missing_file(suffix, tmp_path):
    path = tmp_path / f"none{suffix}"
    assert refusal(path) == f"{path}: no such file"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_empty_file(suffix, tmp_path):
    path = tmp_path / f"empty{suffix}"
    path.touch()
    assert refusal(path) == f"{path}: the file is empty (0 bytes)"


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_folder(suffix, tmp_path):
    path = tmp_path / f"folder{suffix}"
    path.mkdir()
    assert f"{path}: " in refusal(path)


@pytest.mark.parametrize("name", ["a.txt", "a", "a.parquet.gz"])
def test_another_kind_of_file(name, tmp_path):
    path = tmp_path / name
    path.write_text("time")
    assert refusal(path) == f"{path}: a recording is a .parquet or a .csv file"
    with pytest.raises(BadRecordingError, match=r"\.parquet or a \.csv file"):
        write_recording(recording(), path)


def test_text_called_parquet(tmp_path):
    path = tmp_path / "a.parquet"
    path.write_text("time,position.knee\n" + "0,1\n" * 100)
    assert f"{path}: cannot be read as Parquet: " in refusal(path)


def test_parquet_called_csv(tmp_path):
    path = tmp_path / "a.parquet"
    write_recording(recording(), path)
    path = path.rename(tmp_path / "a.csv")
    assert f"{path}: " in refusal(path, METADATA)


def test_a_truncated_parquet_file(tmp_path):
    path = tmp_path / "a.parquet"
    write_recording(recording(), path)
    content = path.read_bytes()
    for length in range(1, len(content), 97):
        path.write_bytes(content[:length])
        assert f"{path}: cannot be read as Parquet: " in refusal(path)


def test_a_flipped_bit_in_the_values_is_found(tmp_path):
    path = tmp_path / "a.parquet"
    rng = np.random.default_rng(5)
    columns = {"time": np.arange(100.0)}
    columns |= {name: rng.normal(size=100) for name in ("position.a", "command.a")}
    original = Recording(columns, METADATA)
    write_recording(original, path)
    content = path.read_bytes()
    last = pq.ParquetFile(path).metadata.row_group(0).column(2)
    first = last.dictionary_page_offset
    for where in range(first, first + last.total_compressed_size, 5):
        damaged = bytearray(content)
        damaged[where] ^= 4
        path.write_bytes(damaged)
        try:
            read = read_recording(path)
        except BadRecordingError:
            continue
        # Then it was in what is not needed for the values, such as their range.
        np.testing.assert_equal(read.columns, original.columns)


def test_damage_anywhere_is_no_surprise(tmp_path):
    path = tmp_path / "a.parquet"
    write_recording(recording(), path)
    content = path.read_bytes()
    rng = np.random.default_rng(7)
    refused = 0
    for where in rng.integers(len(content), size=400):
        damaged = bytearray(content)
        damaged[where] ^= int(rng.integers(1, 256))
        path.write_bytes(damaged)
        try:
            read_recording(path)
        except BadRecordingError:
            refused += 1
    assert refused > 200
