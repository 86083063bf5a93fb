"""Several recordings are written all, or none of them is."""

import numpy as np
import pytest

from groundwalk.errors import BadValueError
from worlds import Recording, RecordingMetadata, read_recording
from worlds.recordings import many

COLUMNS = {"time": np.arange(3.0), "position.a": np.zeros(3), "command.a": np.zeros(3)}
RECORDING = Recording(COLUMNS, RecordingMetadata("arm", "fixed", "a test"))


def files(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_all_are_written(tmp_path):
    paths = [tmp_path / "new" / "deep" / name for name in ("1.parquet", "2.csv")]
    many.write_recordings(dict.fromkeys(paths, RECORDING))
    for path in paths:
        assert read_recording(path).joints == ("a",)
    assert files(paths[0].parent) == ["1.parquet", "2.csv", "2.json"]


@pytest.mark.parametrize("there", ["2.csv", "2.json"])
def test_nothing_is_overwritten(tmp_path, there):
    (tmp_path / there).write_text("mine")
    paths = [tmp_path / name for name in ("1.parquet", "2.csv")]
    with pytest.raises(BadValueError, match="exists already"):
        many.write_recordings(dict.fromkeys(paths, RECORDING))
    assert files(tmp_path) == [there]
    assert (tmp_path / there).read_text() == "mine"


@pytest.mark.parametrize("call", ["write_recording", "os.link"])
def test_nothing_is_left_after_an_error(tmp_path, monkeypatch, call):
    thing, _, name = call.rpartition(".")
    owner = getattr(many, thing) if thing else many
    real, calls = getattr(owner, name), []

    def full(*arguments):
        calls.append(arguments)
        if len(calls) == 2:
            raise OSError("no space left on device")
        real(*arguments)

    monkeypatch.setattr(owner, name, full)
    paths = [tmp_path / "new" / f"{k}.parquet" for k in range(3)]
    with pytest.raises(OSError, match="no space"):
        many.write_recordings(dict.fromkeys(paths, RECORDING))
    assert files(tmp_path) == []
