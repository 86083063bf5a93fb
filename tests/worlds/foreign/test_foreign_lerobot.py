"""LeRobot's data sets: episodes, units, and the ranges of percentages."""

import json
import math

import numpy as np
import pytest
from foreign_files import write_calibration, write_lerobot

from groundwalk.errors import ForeignFileError, GroundwalkError, UnknownNameError
from worlds.foreign import LeRobotOptions, read_lerobot

NAMES = ("pan.pos", "lift.pos")
STATE = np.array([[0, 90], [45, -90], [90, 180]])


@pytest.fixture
def folder(tmp_path):
    return write_lerobot(
        tmp_path / "set", [(STATE, STATE + 1), (STATE[:2], STATE[:2])], NAMES
    )


def test_an_episode_is_a_recording(folder):
    first, second = read_lerobot(folder, LeRobotOptions(("deg",)))
    assert first.joints == ("pan", "lift")
    assert (first.name, second.name) == ("set_episode_000", "set_episode_001")
    assert first.robot == "so101_follower"
    np.testing.assert_array_equal(first.columns["time"], np.arange(3) / 30)
    np.testing.assert_allclose(
        first.columns["position.pan"], [0, math.pi / 4, math.pi / 2]
    )
    np.testing.assert_allclose(
        first.columns["command.lift"], np.array([91, -89, 181]) * math.pi / 180
    )
    assert second.columns["time"].size == 2


def test_units_must_be_given(folder):
    with pytest.raises(ForeignFileError, match="--unit deg"):
        read_lerobot(folder, LeRobotOptions())
    (first, _) = read_lerobot(folder, LeRobotOptions(("rad",)))
    assert first.columns["position.lift"].tolist() == [90, -90, 180]
    with pytest.raises(UnknownNameError, match="did you mean 'deg'"):
        read_lerobot(folder, LeRobotOptions(("deh",)))
    with pytest.raises(UnknownNameError, match="did you mean 'lift'"):
        read_lerobot(folder, LeRobotOptions(("deg", "lft=rad")))


def test_percent_is_of_the_calibrated_range(tmp_path, folder):
    """1024 steps are a quarter of a turn: 100 percent are an eighth from the middle."""
    file = write_calibration(tmp_path / "arm.json", pan=(1000, 2024), lift=(0, 4096, 1))
    options = LeRobotOptions(("percent",), file)
    first, _ = read_lerobot(folder, options)
    np.testing.assert_allclose(
        first.columns["position.pan"], np.array([0, 0.45, 0.9]) * math.pi / 4
    )
    np.testing.assert_allclose(
        first.columns["position.lift"], -np.array([0.9, -0.9, 1.8]) * math.pi
    )
    with pytest.raises(ForeignFileError, match="--calibration"):
        read_lerobot(folder, LeRobotOptions(("percent",)))


def test_a_gripper_counts_from_0_to_100(tmp_path):
    folder = write_lerobot(
        tmp_path / "set", [([[50], [100], [0]], [[0], [0], [0]])], ["gripper.pos"]
    )
    with pytest.raises(ForeignFileError, match="gripper=percent_0_100"):
        read_lerobot(folder, LeRobotOptions(("deg",)))
    file = write_calibration(tmp_path / "arm.json", gripper=(0, 2048))
    options = LeRobotOptions(("deg", "gripper=percent_0_100"), file)
    (found,) = read_lerobot(folder, options)
    np.testing.assert_allclose(
        found.columns["position.gripper"], [0, math.pi / 2, -math.pi / 2]
    )


def test_a_joint_that_is_left_out_needs_no_unit(folder):
    options = LeRobotOptions(("pan=deg",), without=("lift",))
    assert read_lerobot(folder, options)[0].joints == ("pan",)
    with pytest.raises(UnknownNameError, match="did you mean 'lift'"):
        read_lerobot(folder, LeRobotOptions(("deg",), without=("left",)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"codebase_version": "v2.1"}, "v2.1; v3 is read"),
        ({"features": {}}, "no 'observation.state'"),
        ({"fps": None}, "a number above 0"),
    ],
)
def test_what_info_must_say(folder, change, words):
    path = folder / "meta" / "info.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(ForeignFileError, match=words):
        read_lerobot(folder, LeRobotOptions(("deg",)))


def test_names_within_an_object_and_of_other_things(tmp_path):
    features = {
        one: {"names": {"motors": ["pan", "lift"]}}
        for one in ("action", "observation.state")
    }
    folder = write_lerobot(tmp_path / "a", [(STATE, STATE)], NAMES, features=features)
    assert read_lerobot(folder, LeRobotOptions(("deg",)))[0].joints == ("pan", "lift")
    base = write_lerobot(tmp_path / "b", [(STATE, STATE)], ["x.vel", "theta.vel"])
    with pytest.raises(ForeignFileError, match=r"x\.vel"):
        read_lerobot(base, LeRobotOptions(("deg",)))


def test_damaged_files(folder):
    file = next(folder.glob("data/*/file-001.parquet"))
    file.write_bytes(file.read_bytes()[:-20])
    with pytest.raises(ForeignFileError, match=r"file-001\.parquet: cannot be read"):
        read_lerobot(folder, LeRobotOptions(("deg",)))
    for one in folder.glob("data/*/*.parquet"):
        one.unlink()
    with pytest.raises(ForeignFileError, match="no data"):
        read_lerobot(folder, LeRobotOptions(("deg",)))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[]", "must be an object"),
        ('{"pan": {"id": 1}}', "calibration.pan has no"),
        ("{", "is not JSON"),
    ],
)
def test_damaged_calibrations(tmp_path, folder, text, words):
    file = tmp_path / "arm.json"
    file.write_text(text)
    with pytest.raises(GroundwalkError, match=words):
        read_lerobot(folder, LeRobotOptions(("percent",), file))


def test_ranges_without_extent(tmp_path, folder):
    file = write_calibration(tmp_path / "arm.json", pan=(5, 5), lift=(0, 1))
    with pytest.raises(ForeignFileError, match="range_max is 5"):
        read_lerobot(folder, LeRobotOptions(("percent",), file))
