import pytest

from experiments.runs.folder import check_new
from groundwalk.errors import BadValueError


def test_a_new_file_is_fine(tmp_path):
    check_new(tmp_path / "folder" / "new.rrd", ".rrd")


def test_what_is_there_is_not_new(tmp_path):
    for path in (tmp_path, tmp_path / "a.rrd"):
        if path.suffix:
            path.touch()
        with pytest.raises(BadValueError, match="exists already: choose another"):
            check_new(path)


def test_another_ending(tmp_path):
    with pytest.raises(BadValueError, match=r"a\.png must end with \.rrd"):
        check_new(tmp_path / "a.png", ".rrd")
