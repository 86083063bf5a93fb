import shutil
from pathlib import Path

import pytest

from experiments.record import Record, make_recording
from experiments.runs.robot_model import model_note, robot_model
from groundwalk.errors import BadRecordingError


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with two recordings of one arm, which is the current one."""
    monkeypatch.chdir(tmp_path)
    for name in ("a", "b"):
        options = {"robot": "pendulum", "world": "sim", "duration": 1.0}
        make_recording(Record(Path(f"{name}.parquet"), **options))
    return tmp_path


def test_a_given_model_is_used(here):
    assert robot_model([Path("a.parquet")], "other.xml") == "other.xml"


def test_recordings_of_one_arm_state_it_by_equal_files(here):
    files = [Path("a.parquet"), Path("b.parquet")]
    assert robot_model(files, "") == "a.nominal.xml"
    assert robot_model([here], "") == str(here / "a.nominal.xml")


def test_a_model_is_found_beside_its_recording(here, monkeypatch):
    (here / "elsewhere").mkdir()
    monkeypatch.chdir(here / "elsewhere")
    assert robot_model([Path("../a.parquet")], "") == "../a.nominal.xml"


def test_recordings_of_different_models_need_a_given_one(here):
    model = Path("b.nominal.xml")
    model.write_text(model.read_text().replace("mass=", "friction='1' mass=", 1))
    with pytest.raises(BadRecordingError, match=r"a\.nominal\.xml, b\.parquet"):
        robot_model([Path("a.parquet"), Path("b.parquet")], "")


def test_a_model_that_is_gone_is_told_in_one_line(here):
    Path("a.nominal.xml").unlink()
    with pytest.raises(BadRecordingError, match="give one with --robot") as told:
        robot_model([Path("a.parquet")], "")
    assert "a.nominal.xml" in str(told.value)
    assert "\n" not in str(told.value)


def test_another_model_than_the_stated_one_is_noted(here):
    recordings, other = [Path("a.parquet")], Path("other.xml")
    assert model_note(recordings, "a.nominal.xml") == ""
    shutil.copy("a.nominal.xml", other)
    assert model_note(recordings, str(other)) == ""
    other.write_text(other.read_text().replace("<joint ", '<joint armature="0.5" ', 1))
    assert model_note(recordings, str(other)) == (
        "a.parquet states the model a.nominal.xml, from which other.xml differs in "
        "rotor inertia (armature) at 1 joint"
    )


def test_nothing_is_noted_where_the_stated_model_cannot_be_found(here):
    Path("a.nominal.xml").rename("moved.xml")
    assert model_note([Path("a.parquet")], "moved.xml") == ""
