from dataclasses import replace

import numpy as np
import pytest

import robots
from groundwalk.errors import BadRecordingError, BadValueError
from robots.scale import NAO_HIP_M, Scale
from terrain import Heightfield
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording
from worlds.scenes.scene import Scene, check_beside, content_id

NAO = robots.get("nao")
FLAT = Heightfield(np.zeros((3, 3)), (-1.0, -1.0), 1.0)
SENSORS = ("front_left", "front_right", "rear_left", "rear_right")


def scene(name="sim", ground=None, metadata=None, **columns):
    values = {
        "time": [0.0, 0.01],
        "position.LKneePitch": [0.5, 0.6],
        "command.LKneePitch": [0.5, 0.5],
    }
    about = {"robot": "nao", "base": "floating", "source": "a test"}
    return Scene(
        name,
        Recording(
            {**values, **{key.replace("__", "."): of for key, of in columns.items()}},
            RecordingMetadata(**{**about, **(metadata or {})}),
        ),
        NAO,
        ground,
    )


def test_a_joint_that_the_robot_has_not_is_named():
    with pytest.raises(
        BadRecordingError, match="'LKneePitsch', which robot nao has no"
    ):
        scene(position__LKneePitsch=[0.0, 0.0])


@pytest.mark.parametrize("name", ["sim", "start/sim", "walk_2.5-b/real"])
def test_names_that_are_paths(name):
    assert scene(name).name == name


@pytest.mark.parametrize(
    "name", ["", "/sim", "sim/", "a//b", "a b", "ä", "__x", "sim\n"]
)
def test_names_that_are_no_paths(name):
    with pytest.raises(BadValueError, match="scene name"):
        scene(name)


def test_scenes_that_can_stand_side_by_side():
    check_beside([scene("sim"), scene("sim2"), scene("real/1"), scene("real/2")])


@pytest.mark.parametrize("names", [["sim", "sim"], ["a/b", "a-b", "a"], []])
def test_scenes_that_cannot(names):
    with pytest.raises(BadValueError, match="scenes"):
        check_beside([scene(name) for name in names])


def test_without_a_recorded_base_the_root_stays_at_the_origin():
    root = scene().link_poses()["torso"]
    np.testing.assert_array_equal(root.position_m, np.zeros((2, 3)))
    np.testing.assert_array_equal(root.orientation, [[1, 0, 0, 0]] * 2)


def test_the_base_and_the_joints_are_those_of_the_recording():
    base = {f"base__position__{axis}": [k, k + 1.0] for k, axis in enumerate("xyz")}
    poses = scene(**base).link_poses()
    np.testing.assert_array_equal(poses["torso"].position_m, [[0, 1, 2], [1, 2, 3]])
    # Only the left knee is bent; what was not recorded is straight.
    knee_rad = np.array([0.5, 0.6])
    np.testing.assert_allclose(poses["LTibia"].orientation[:, 0], np.cos(knee_rad / 2))
    np.testing.assert_array_equal(poses["RTibia"].orientation, [[1, 0, 0, 0]] * 2)


def test_the_force_on_a_foot_is_the_recorded_sum():
    force = scene(foot_force__left=[1.0, 2.0], foot_force__right=[3.0, 4.0])
    np.testing.assert_array_equal(force.foot_force_n("right"), [3, 4])


def test_the_force_on_a_foot_is_that_of_its_sensors_where_no_sum_was_recorded():
    columns = {f"foot_force__left__{k}": [1.0, 10.0] for k in SENSORS}
    sensors = scene(**columns)
    np.testing.assert_array_equal(sensors.foot_force_n("left"), [4, 40])
    assert sensors.foot_force_n("right") is None


def test_sensor_forces_act_at_the_sensors_on_the_sole():
    columns = {
        f"foot_force__right__{sensor}": [k, k + 0.5] for k, sensor in enumerate(SENSORS)
    }
    points_m, forces_n = scene(**columns).sensor_forces_n("right")
    np.testing.assert_array_equal(forces_n, [[0, 1, 2, 3], [0.5, 1.5, 2.5, 3.5]])
    np.testing.assert_array_equal(points_m[:, :2], NAO.feet[1].sensors_m)
    np.testing.assert_array_equal(points_m[:, 2], [-0.04511] * 4)


def test_a_sum_acts_in_the_middle_of_the_sensors():
    force = scene(foot_force__left=[1.0, 2.0], foot_force__right=[3.0, 4.0])
    points_m, forces_n = force.sensor_forces_n("left")
    np.testing.assert_array_equal(forces_n, [[1], [2]])
    middle = [(0.07025 * 2 - 0.03025 - 0.02965) / 4, (0.0299 * 2 - 0.0231 - 0.0191) / 4]
    np.testing.assert_allclose(points_m, [[*middle, -0.04511]], atol=1e-15)


def test_no_forces_were_recorded():
    assert scene().foot_force_n("left") is None
    assert scene().sensor_forces_n("left") is None


def test_pitch_joints_come_from_the_hip_down():
    columns = {
        f"position__{joint}": [0.0, 0.0]
        for joint in NAO.joints
        if joint != "RKneePitch"
    }
    legs = scene(**columns)
    assert legs.pitch_joints("left") == ("LHipPitch", "LKneePitch", "LAnklePitch")
    assert legs.pitch_joints("right") == ("RHipPitch", "RAnklePitch")


def test_title_and_properties():
    terrain = {"name": "flat", "seed": 3}
    fallen = scene(metadata={"end": "fall", "world": "real", "terrain": terrain})
    assert fallen.title == "sim: fall at 0.01 s"
    assert fallen.properties == {
        "robot": "nao",
        "base": "floating",
        "source": "a test",
        "world": "real",
        "end": "fall",
        "terrain": '{"name": "flat", "seed": 3}',
    }
    assert scene().title == "sim"


def test_an_id_belongs_to_the_contents():
    same = content_id([scene(ground=FLAT)])
    assert same == content_id([scene(ground=FLAT)])
    other = Heightfield(np.full((3, 3), 0.1), (-1.0, -1.0), 1.0)
    others = [
        [scene("real", ground=FLAT)],
        [scene()],
        [scene(ground=other)],
        [scene(ground=FLAT, metadata={"source": "another"})],
        [scene(ground=FLAT, position__LKneePitch=[0.5, 0.7])],
        [scene(ground=FLAT), scene("real")],
    ]
    assert len({same, *map(content_id, others)}) == 7


def test_a_robots_weight_is_as_long_as_its_legs():
    nao = robots.get("nao")
    twice = replace(nao, scale=Scale(length=2.0, weight=7.0))
    small, large = (
        Scene("sim", scene().recording, robot).arrow_m_per_n * weight_n
        for robot, weight_n in ((nao, 52.0), (twice, 7 * 52.0))
    )
    assert small == pytest.approx(NAO_HIP_M, rel=0.1)
    assert large == pytest.approx(2 * small)
