"""A recording is known by what is in it, whatever its file is called."""

import numpy as np
import pytest

from experiments.prediction.used import content_of, sort_out
from groundwalk.errors import BadRecordingError
from worlds import Recording, RecordingMetadata
from worlds.recordings.files import write_recording


def recording(seed, **columns):
    rng = np.random.default_rng(seed)
    known = {"time": 0.01 * np.arange(20)}
    known |= {
        f"{one}.swing": rng.standard_normal(20) for one in ("position", "command")
    }
    about = RecordingMetadata(robot="pendulum", base="fixed", source=f"a test, {seed}")
    return Recording(known | columns, about)


def write(folder, name, seed):
    write_recording(recording(seed), folder / name)
    return folder / name


def test_the_same_values_have_the_same_hash():
    gap = np.where(np.arange(20) == 3, np.nan, 1.0)
    one = recording(1, **{"torque.swing": gap})
    assert content_of(one) == content_of(recording(1, **{"torque.swing": gap.copy()}))
    assert content_of(one) != content_of(recording(1))
    assert content_of(recording(1)) != content_of(recording(2))


def test_a_used_recording_is_known_in_another_file_and_format(tmp_path):
    seen = write(tmp_path, "seen.parquet", 1)
    again, new = write(tmp_path, "again.csv", 1), write(tmp_path, "new.parquet", 2)
    found = sort_out([again, new], [seen])
    assert (found.used, found.new, found.limits) == ((again,), (new,), ())


def test_the_name_alone_says_nothing(tmp_path):
    (tmp_path / "other").mkdir()
    seen = write(tmp_path, "a.parquet", 1)
    new = write(tmp_path / "other", "a.parquet", 2)
    assert sort_out([new], [tmp_path / "a.parquet"]).new == (new,)
    assert sort_out([tmp_path / "other"], [seen]).new == (new,)  # folders, too


def test_used_recordings_alone_are_refused(tmp_path):
    seen = write(tmp_path, "seen.parquet", 1)
    with pytest.raises(BadRecordingError, match="all of these recordings were used"):
        sort_out([seen], [seen])


def test_a_recording_given_twice_is_refused(tmp_path):
    files = write(tmp_path, "a.parquet", 1), write(tmp_path, "b.csv", 1)
    with pytest.raises(BadRecordingError, match="the same rows"):
        sort_out(files, [])


def test_a_used_recording_that_is_gone_is_named(tmp_path):
    new = write(tmp_path, "new.parquet", 1)
    found = sort_out([new], [tmp_path / "gone.parquet"])
    assert found.new == (new,)
    (said,) = found.limits
    assert "gone.parquet" in said
