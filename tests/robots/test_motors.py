"""Motors of the MuJoCo model against the closed form of a torque-speed line."""

import mujoco
import numpy as np
import pytest

STATES = 300


@pytest.fixture(scope="module")
def motors(nao):
    """Arrays over the joints of each number of their motors."""
    names = ("stall_torque_nm", "no_load_speed_rad_s", "kp_nm_rad", "kd_nm_s_rad")
    return {
        name: np.array([getattr(joint.motor, name) for joint in nao.links])
        for name in names
    }


def forces(model, position_rad, velocity_rad_s, command_rad):
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = position_rad, velocity_rad_s
    data.ctrl[:] = command_rad
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.qfrc_actuator, data.actuator_force)
    return data.actuator_force.copy()


def test_small_errors_are_a_spring_and_a_damper(fixed_model, motors, random_poses):
    generator = np.random.default_rng(11)
    for pose in random_poses(STATES, seed=10):
        error, speed = generator.uniform(-0.1, 0.1, 20), generator.uniform(-1, 1, 20)
        expected = motors["kp_nm_rad"] * error - motors["kd_nm_s_rad"] * speed
        torque = forces(fixed_model, pose, speed, pose + error)
        np.testing.assert_allclose(torque, expected, rtol=0, atol=1e-9)


def test_torque_keeps_to_the_line_between_stall_and_no_load(
    fixed_model, motors, random_poses
):
    generator = np.random.default_rng(13)
    stall = motors["stall_torque_nm"]
    saturated = 0
    for pose in random_poses(STATES, seed=12):
        share = generator.uniform(-1.5, 1.5, 20)  # of the speed without load
        error = generator.uniform(-0.5, 0.5, 20)
        speed = share * motors["no_load_speed_rad_s"]
        wanted = motors["kp_nm_rad"] * error - motors["kd_nm_s_rad"] * speed
        low, high = stall * (-1 - share), stall * (1 - share)
        torque = forces(fixed_model, pose, speed, pose + error)
        expected = np.clip(wanted, low, high)
        np.testing.assert_allclose(torque, expected, rtol=0, atol=1e-9)
        saturated += np.count_nonzero(expected != wanted)
    assert saturated > STATES  # the limits were reached


def test_stalled_and_spinning(fixed_model, motors, crouch):
    """At rest a motor gives its stall torque, at its no-load speed nothing."""
    still, top = np.zeros(20), motors["no_load_speed_rad_s"]
    far = crouch + 1.0
    torque = forces(fixed_model, crouch, still, far)
    np.testing.assert_allclose(torque, motors["stall_torque_nm"], rtol=1e-12)
    np.testing.assert_allclose(forces(fixed_model, crouch, top, far), 0, atol=1e-9)


@pytest.mark.parametrize("name", ["LElbowYaw", "RElbowYaw", "LShoulderPitch"])
def test_no_joint_runs_faster_than_without_load(fixed_model, nao, name):
    """Driven hard through its range without gravity, from one end to the other."""
    data = mujoco.MjData(fixed_model)
    gravity = fixed_model.opt.gravity.copy()
    low, high = nao.joint_range_rad.T
    column = nao.joints.index(name)
    data.qpos[:] = np.clip(0.0, low, high)
    data.qpos[column] = low[column]
    data.ctrl[:] = data.qpos
    data.ctrl[column] = 100.0
    fastest = 0.0
    try:
        fixed_model.opt.gravity[:] = 0
        while data.qpos[column] < high[column] - 0.1:
            mujoco.mj_step(fixed_model, data)
            fastest = max(fastest, data.qvel[column])
    finally:
        fixed_model.opt.gravity[:] = gravity
    limit = nao.no_load_speed_rad_s[column]
    assert 0.98 * limit < fastest < 1.001 * limit


def test_nothing_but_motors_moves_or_brakes_a_joint(model):
    assert not model.dof_armature.any()
    assert not model.dof_damping.any()
    assert not model.dof_frictionloss.any()
    assert not model.jnt_stiffness.any()
