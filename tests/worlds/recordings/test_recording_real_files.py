"""Recordings of real robots that are no part of the project: read, if there are any."""

from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest

from worlds.recordings.files import read_recording, write_recording

DATA = Path(__file__).parents[3] / ".." / "shared" / "data"
FILES = sorted(DATA.glob("*/*.parquet"))

pytestmark = pytest.mark.skipif(
    not FILES, reason="no real recordings in ../shared/data beside the repository"
)


@pytest.mark.parametrize(
    "path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}"
)
def test_real_files_are_read_as_they_are(path):
    recording = read_recording(path)
    table = pq.read_table(path)
    assert list(recording.columns) == table.column_names
    for name, values in recording.columns.items():
        np.testing.assert_array_equal(values, table[name].to_numpy())
    assert recording.metadata.base == "fixed"
    assert recording.joints_with("command") == recording.joints


@pytest.mark.parametrize(
    ("name", "robot", "joints", "ticks", "duration_s"),
    [
        ("emps/sweep", "emps.xml", 1, 24841, 24.84),
        ("go2/air", "go2", 12, 4698, 23.49),
        ("so101/multisine", "so101", 5, 6000, 120.342),
    ],
)
def test_what_is_known_of_real_files(name, robot, joints, ticks, duration_s):
    recording = read_recording(DATA / f"{name}.parquet")
    assert recording.metadata.robot == robot
    assert len(recording.joints) == joints
    assert recording.ticks == ticks
    assert recording.duration_s == pytest.approx(duration_s, abs=1e-3)


@pytest.mark.parametrize("suffix", [".parquet", ".csv"])
def test_a_real_file_survives_being_written_again(suffix, tmp_path):
    original = read_recording(DATA / "so101" / "figure_eight.parquet")
    path = tmp_path / f"again{suffix}"
    write_recording(original, path)
    again = read_recording(path)
    assert again.metadata == original.metadata
    for name, values in original.columns.items():
        assert again.columns[name].tobytes() == values.tobytes()
