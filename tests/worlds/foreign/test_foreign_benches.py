"""Logs of BAM, data of PACE, what a source is, and names of joints."""

import json

import numpy as np
import pytest

from groundwalk.errors import BadRecordingError, ForeignFileError
from worlds import RecordingMetadata
from worlds.foreign import ForeignRecording, kind_of, read_bam, read_pace


def entry(k, on=True):
    return {
        "timestamp": 0.01 * k,
        "position": 0.5 * k,
        "speed": 50.0,
        "goal_position": 1.0,
        "torque_enable": on,
        "load": 3.0,
    }


def write_log(path, entries, **more):
    about = {"mass": 0.5, "length": 0.1, "kp": 32, "vin": 12.0, "motor": "sts3215"}
    path.write_text(json.dumps(about | more | {"entries": entries}))
    return path


def test_a_log_of_bam(tmp_path):
    path = write_log(tmp_path / "sin.json", [entry(k) for k in range(20)])
    (found,) = read_bam(path)
    assert found.name == "sin"
    np.testing.assert_allclose(found.columns["time"], 0.01 * np.arange(20))
    np.testing.assert_allclose(found.columns["position.pendulum"], 0.5 * np.arange(20))
    assert set(found.columns["command.pendulum"]) == {1.0}
    assert set(found.columns["velocity.pendulum"]) == {50.0}
    for words in ("sts3215", "mass 0.5 kg", "length 0.1 m", "kp 32", "vin 12 V"):
        assert words in found.source


def test_a_motor_that_is_off_drives_nothing(tmp_path):
    entries = [entry(k, on=not 20 <= k < 40) for k in range(60)]
    first, second = read_bam(write_log(tmp_path / "drop.json", entries))
    assert (first.name, second.name) == ("drop_1", "drop_2")
    assert first.columns["time"][-1] == pytest.approx(0.19)
    assert second.columns["time"][0] == pytest.approx(0.4)
    assert "20 rows" in first.notes[0]
    with pytest.raises(ForeignFileError, match="not on"):
        read_bam(write_log(tmp_path / "off.json", [entry(k, False) for k in range(9)]))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "is not JSON"),
        ("[1]", "no 'entries'"),
        ('{"entries": []}', "no 'entries'"),
        ('{"entries": [{"timestamp": 0, "goal_position": 0}]}', r"'position' .*\[0\]"),
        ('{"entries": [{"timestamp": "0"}]}', "must be a number, not '0'"),
    ],
)
def test_damaged_logs(tmp_path, text, words):
    path = tmp_path / "log.json"
    path.write_text(text)
    with pytest.raises(ForeignFileError, match=words):
        read_bam(path)


TIME = np.arange(4) * 0.0025
ANGLES = np.arange(8.0).reshape(4, 2)


def test_data_of_pace(tmp_path):
    path = tmp_path / "chirp.npz"
    np.savez(path, time=TIME, dof_pos=ANGLES, des_dof_pos=-ANGLES)
    found = read_pace(path)
    assert found.joints == ("1", "2")
    assert found.columns["position.2"].tolist() == [1, 3, 5, 7]
    assert found.columns["command.1"].tolist() == [0, -2, -4, -6]
    assert found.numbered(["HAA", "HFE"]).joints == ("HAA", "HFE")
    with pytest.raises(ForeignFileError, match="3 names"):
        found.numbered(["HAA", "HFE", "KFE"])
    names = np.array(["HAA", "HFE"])
    np.savez(path, time=TIME, dof_pos=ANGLES, des_dof_pos=ANGLES, joint_names=names)
    assert read_pace(path).joints == ("HAA", "HFE")


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"time": TIME, "dof_pos": ANGLES}, "no array 'des_dof_pos'"),
        ({"time": TIME, "dof_pos": ANGLES, "des_dof_pos": ANGLES[1:]}, "shape"),
        ({"time": [TIME], "dof_pos": ANGLES, "des_dof_pos": ANGLES}, "shape"),
        (
            {"time": TIME, "dof_pos": ["a"], "des_dof_pos": ANGLES},
            "no array of numbers",
        ),
    ],
)
def test_damaged_data_of_pace(tmp_path, arrays, words):
    np.savez(tmp_path / "data.npz", **arrays)
    with pytest.raises(ForeignFileError, match=words):
        read_pace(tmp_path / "data.npz")


def test_no_code_of_a_file_is_run(tmp_path):
    np.savez(tmp_path / "data.npz", time=np.array([{}], object))
    with pytest.raises(ForeignFileError, match="cannot be read"):
        read_pace(tmp_path / "data.npz")
    (tmp_path / "chirp.pt").write_bytes(b"anything")
    with pytest.raises(ForeignFileError, match="weights_only=True"):
        read_pace(tmp_path / "chirp.pt")


@pytest.mark.parametrize("kept", [0, 4, 200, 400])
def test_archives_that_are_cut_off(tmp_path, kept):
    path = tmp_path / "cut.npz"
    np.savez(path, time=TIME, dof_pos=ANGLES, des_dof_pos=ANGLES)
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(ForeignFileError, match="cannot be read"):
        read_pace(path)


def test_what_a_source_is(tmp_path):
    for name, kind in (("a.CSV", "table"), ("a.mcap", "bag"), ("a.json", "bam")):
        (tmp_path / name).touch()
        assert kind_of(tmp_path / name) == kind
    for name, words in (("a.bag", "rosbags-convert"), ("a.h5", "no known kind")):
        (tmp_path / name).touch()
        with pytest.raises(ForeignFileError, match=words):
            kind_of(tmp_path / name)
    with pytest.raises(ForeignFileError, match="neither"):
        kind_of(tmp_path)
    (tmp_path / "metadata.yaml").touch()
    assert kind_of(tmp_path) == "bag"
    with pytest.raises(ForeignFileError, match="no such"):
        kind_of(tmp_path / "b.mcap")


def foreign(*joints, start_s=0.0):
    columns = {"time": start_s + np.arange(3.0)}
    columns |= {f"position.{joint}": np.arange(3.0) for joint in joints}
    columns |= {f"command.{joint}": np.arange(3.0) for joint in joints}
    return ForeignRecording("log", columns, "a test")


def test_joints_get_other_names():
    found = foreign("fer_1", "fer_2", "grip")
    assert found.renamed({"grip": "claw"}).joints == ("fer_1", "fer_2", "claw")
    new = found.renamed({"fer_*": "panda_*"})
    assert new.joints == ("panda_1", "panda_2", "grip")
    assert "command.panda_2" in new.columns
    assert found.without(["grip"]).joints == ("fer_1", "fer_2")


@pytest.mark.parametrize(
    ("pairs", "words"),
    [({"grop": "a"}, "did you mean 'grip'"), ({"arm": "grip"}, "two joints")],
)
def test_names_that_cannot_be_given(pairs, words):
    with pytest.raises(ForeignFileError, match=words):
        foreign("arm", "grip").renamed(pairs)


def test_joints_that_cannot_be_left_out():
    with pytest.raises(ForeignFileError, match="did you mean 'arm'"):
        foreign("arm").without(["aem"])
    with pytest.raises(ForeignFileError, match="no joint would be left"):
        foreign("arm").without(["arm"])


def test_a_recording_is_checked():
    metadata = RecordingMetadata("arm", "fixed", "a test")
    made = foreign("arm", start_s=1.7e9).recording(metadata)
    assert made.time_s.tolist() == [0, 1, 2]
    wrong = foreign("arm")
    wrong.columns["time"][1] = 5.0
    with pytest.raises(BadRecordingError, match="row 2"):
        wrong.recording(metadata)
