import mujoco
import numpy as np
import pytest

import robots
from robots.engine_models.mjcf import mujoco_spec
from worlds.scenes.scene import LinkPoses, link_poses

NAO = robots.get("nao")
LINKS = [NAO.root.name, *(joint.link.name for joint in NAO.links)]


def random_base(rng, ticks):
    turns = rng.normal(size=(ticks, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    return LinkPoses(rng.uniform(-2, 2, (ticks, 3)), turns)


def rotation_matrices(orientation):
    matrices = np.empty((len(orientation), 9))
    for matrix, quaternion in zip(matrices, orientation, strict=True):
        mujoco.mju_quat2Mat(matrix, quaternion)
    return matrices


def still(ticks=1):
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (ticks, 1))
    return LinkPoses(np.zeros((ticks, 3)), upright)


def test_agrees_with_mujoco_at_random_poses():
    rng = np.random.default_rng(1)
    ticks = 300
    base = random_base(rng, ticks)
    angles = rng.uniform(*NAO.joint_range_rad.T, (ticks, len(NAO.joints)))
    poses = link_poses(NAO, angles, base)
    assert list(poses) == LINKS

    model = mujoco_spec(NAO).compile()
    data = mujoco.MjData(model)
    matrices = {
        name: rotation_matrices(pose.orientation) for name, pose in poses.items()
    }
    for tick in range(ticks):
        data.qpos[:] = [*base.position_m[tick], *base.orientation[tick], *angles[tick]]
        mujoco.mj_kinematics(model, data)
        for name, pose in poses.items():
            body = data.body(name)
            np.testing.assert_allclose(pose.position_m[tick], body.xpos, atol=1e-9)
            np.testing.assert_allclose(matrices[name][tick], body.xmat, atol=1e-9)


def test_points_go_with_their_link():
    rng = np.random.default_rng(4)
    base, points_m = random_base(rng, 20), rng.normal(size=(3, 3))
    matrices = rotation_matrices(base.orientation).reshape(-1, 3, 3)
    np.testing.assert_allclose(base.axes(), matrices, atol=1e-12)
    found_m = base.points(points_m)
    assert found_m.shape == (20, 3, 3)
    for tick, matrix in enumerate(matrices):
        expected_m = base.position_m[tick] + points_m @ matrix.T
        np.testing.assert_allclose(found_m[tick], expected_m, atol=1e-12)
        np.testing.assert_array_equal(base.at(tick).points(points_m)[0], found_m[tick])


def test_straight_legs_end_where_the_lengths_add_up_to():
    poses = link_poses(NAO, np.zeros((2, len(NAO.joints))), still(2))
    ankle = [0.0, 0.05, -(0.085 + 0.1 + 0.1029)]
    np.testing.assert_allclose(poses["LFoot"].position_m, [ankle, ankle], atol=1e-15)


def test_a_bent_knee_brings_the_ankle_back():
    angles = np.zeros((1, len(NAO.joints)))
    angles[0, NAO.joints.index("LKneePitch")] = np.pi / 2
    poses = link_poses(NAO, angles, still())
    ankle = [[-0.1029, 0.05, -0.185]]
    np.testing.assert_allclose(poses["LFoot"].position_m, ankle, atol=1e-15)


def test_a_base_that_is_not_quite_a_unit_quaternion_counts_as_one():
    rng = np.random.default_rng(2)
    base = random_base(rng, 5)
    longer = LinkPoses(base.position_m, base.orientation * 1.0009)
    angles = np.zeros((5, len(NAO.joints)))
    for exact, scaled in zip(
        link_poses(NAO, angles, base).values(),
        link_poses(NAO, angles, longer).values(),
        strict=True,
    ):
        np.testing.assert_allclose(scaled.position_m, exact.position_m, atol=1e-14)
        np.testing.assert_allclose(scaled.orientation, exact.orientation, atol=1e-14)


@pytest.mark.parametrize(
    ("joint", "reached"),
    [
        ("LAnklePitch", {"LAnkle", "LFoot"}),
        ("RShoulderPitch", {"RShoulder", "RBicep", "RElbow", "RForeArm"}),
    ],
)
def test_a_missing_angle_reaches_what_hangs_on_it_and_nothing_else(joint, reached):
    angles = np.zeros((2, len(NAO.joints)))
    angles[1, NAO.joints.index(joint)] = np.nan
    poses = link_poses(NAO, angles, still(2))
    for name, pose in poses.items():
        assert not np.isnan(pose.orientation[0]).any()
        assert np.isnan(pose.orientation[1]).all() == (name in reached)
