"""The MuJoCo world against MuJoCo itself, and at the size of a search."""

import mujoco
import numpy as np
import pytest

import terrain
from worlds import SensorNoise, WorldOptions
from worlds.sim.world import mujoco_model

MANY = 150


@pytest.fixture(scope="module", params=["flat", "lumps"])
def ground(request):
    return terrain.make(request.param, seed=4)


def test_is_one_mj_step_after_the_other(ground, make_world, nao, crouch, shake):
    """No batch, no rollout, no delay line: the same bits."""
    options = WorldOptions(timestep_s=0.0025)
    world = make_world("sim", [ground], timestep_s=0.0025)
    model = mujoco_model(nao, options, ground)
    data = mujoco.MjData(model)
    observation = world.reset(crouch[None])
    data.qpos[:3], data.qpos[7:] = world.truth().base_position_m[0], crouch
    for command in shake(30, 1):
        targets = command[0].copy()
        targets[[0, 6]] = (targets[0] + targets[6]) / 2
        data.ctrl[:] = targets
        observation = world.step(command)
        for _ in range(4):
            mujoco.mj_step(model, data)
        np.testing.assert_array_equal(observation.position_rad[0], data.qpos[7:])
        np.testing.assert_array_equal(observation.velocity_rad_s[0], data.qvel[6:])
        np.testing.assert_array_equal(
            observation.accelerometer_m_s2[0], data.sensor("accelerometer").data
        )
    truth = world.truth()
    np.testing.assert_array_equal(truth.base_position_m[0], data.qpos[:3])
    np.testing.assert_array_equal(truth.base_orientation[0], data.qpos[3:7])
    np.testing.assert_array_equal(truth.base_linear_velocity_m_s[0], data.qvel[:3])
    np.testing.assert_array_equal(truth.base_angular_velocity_rad_s[0], data.qvel[3:6])


@pytest.mark.parametrize("threads", [1, 2])
def test_one_of_many_is_one_alone(
    make_world, crouch, shake, lumpy, roll, same_bits, threads
):
    grounds = [lumpy[k % 3] for k in range(MANY)]
    commands = shake(12, MANY)
    pose = np.tile(crouch, (MANY, 1))
    # make_world numbers the seeds: robot k has the same one in every world
    many = make_world("sim", grounds, threads=threads, noise=SensorNoise())
    together = roll(many, pose, commands)
    alone = make_world("sim", grounds[:1], noise=SensorNoise())
    same_bits(roll(alone, pose[:1], commands[:, :1]), together, 0, 0)
    three = make_world("sim", grounds[:3], threads=2, noise=SensorNoise())
    some = roll(three, pose[:3], commands[:, :3])
    same_bits(some, together, slice(3), slice(3))
    assert len(np.unique(together["gyroscope_rad_s"][-1, :, 1])) == MANY


def test_a_ground_makes_a_difference(make_world, crouch, lumpy, roll):
    world = make_world("sim", lumpy)
    lower = crouch.copy()
    rollout = roll(world, np.tile(lower, (3, 1)), [np.tile(lower, (3, 1))] * 2)
    np.testing.assert_array_equal(rollout["base_position_m"][0, :, :2], 0)
    world = make_world("sim", [lumpy[0], lumpy[0]])
    pair = roll(world, np.tile(lower, (2, 1)), [np.tile(lower, (2, 1))] * 20)
    np.testing.assert_array_equal(
        pair["position_rad"][:, 0], pair["position_rad"][:, 1]
    )


def test_ends_of_ranges_hold(make_world, nao):
    """Joints told to go beyond their stops stay within a degree of them."""
    world = make_world("sim", fixed_base=True)
    low, high = nao.joint_range_rad.T
    world.reset((low + high)[None] / 2)
    for target, stop in ((low - 0.5, low), (high + 0.5, high)):
        for _ in range(150):
            observation = world.step(target[None])
        beyond = np.abs(observation.position_rad[0] - stop)
        assert np.degrees(beyond).max() < 2.5
