"""One servo law in both worlds: the twin's torque, and joints that move in the air."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from worlds import WorldOptions
from worlds.real.robot import ServoTwin
from worlds.sim.world import mujoco_model

TICKS = 200
FREQUENCIES_HZ = np.array([0.3, 0.7, 1.1, 1.9, 2.3])
ROOT = np.zeros(7), np.zeros(6)  # what a fixed base does not need


@pytest.fixture(scope="module")
def multisine(nao):
    """Commands (ticks, joints): five sines a joint through 30 % of its range."""
    low, high = nao.joint_range_rad.T
    phase = np.random.default_rng(30).uniform(0, 2 * np.pi, (5, 20))
    time_s = 0.01 * np.arange(TICKS)[:, None, None]
    sines = np.sin(2 * np.pi * FREQUENCIES_HZ[:, None] * time_s + phase).sum(axis=1)
    fade_in = np.minimum(time_s[:, 0] / 0.5, 1)
    return (low + high) / 2 + 0.3 * (high - low) / 2 * fade_in * sines / np.sqrt(5)


@pytest.fixture(scope="module")
def in_the_air(make_world, multisine):
    """Function: joint positions (ticks, joints) of a hanging robot."""

    def run(name, timestep_s, **changes):
        world = make_world(name, timestep_s=timestep_s, fixed_base=True, **changes)
        world.reset(multisine[:1])
        return np.array(
            [world.step(command[None]).position_rad[0] for command in multisine]
        )

    return run


@pytest.fixture(scope="module")
def both(in_the_air):
    """Joint positions of both worlds by time step."""
    return {
        step: (in_the_air("sim", step), in_the_air("real", step))
        for step in (0.005, 0.002, 0.0005)
    }


def rms_mrad(first, second):
    """(joints,) root mean square difference."""
    return 1e3 * np.sqrt(np.mean((first - second) ** 2, axis=0))


def with_motor(description, name, **changes):
    links = list(description.links)
    column = description.joints.index(name)
    motor = replace(links[column].motor, **changes)
    links[column] = replace(links[column], motor=motor)
    return replace(description, links=tuple(links))


@pytest.mark.slow
def test_worlds_agree_in_the_air(both):
    """Required: 1 mrad at 0.5 ms, 4 mrad at 2 ms; measured: 0.001 and 0.02 mrad."""
    assert rms_mrad(*both[0.0005]).max() < 0.01
    assert rms_mrad(*both[0.002]).max() < 0.1


@pytest.mark.slow
def test_worlds_come_closer_with_the_step(both):
    coarse, usual, fine = (rms_mrad(*both[step]).max() for step in both)
    assert coarse > 2 * usual
    assert usual > 2 * fine


@pytest.mark.slow
def test_joints_really_move_and_lag(both, multisine):
    for sim, _ in both.values():
        assert np.ptp(sim, axis=0).min() > 0.2
        assert rms_mrad(sim, multisine).mean() > 10


@pytest.mark.slow
def test_another_gain_shows(both, in_the_air, nao):
    """Two per cent more stiffness in one knee is more than the worlds differ by."""
    knee = nao.joints.index("LKneePitch")
    stiffness = nao.links[knee].motor.kp_nm_rad
    other = with_motor(nao, "LKneePitch", kp_nm_rad=1.02 * stiffness)
    sim, real = both[0.002]
    difference = rms_mrad(sim, in_the_air("real", 0.002, description=other))
    assert difference[knee] > 10 * rms_mrad(sim, real)[knee]
    assert difference[knee] > 0.2
    right_knee = nao.joints.index("RKneePitch")
    assert difference[right_knee] < 0.1


@pytest.mark.parametrize("name", ["sim", "real"])
def test_coupled_joints_stay_together_under_uneven_load(nao, make_world, name):
    """The left leg hangs, the right one is held out: 0.5 N m against nothing."""
    first, second = nao.coupled[0]
    low, high = nao.joint_range_rad.T
    pose = np.clip(np.zeros(20), low, high)
    pose[nao.joints.index("RHipPitch")] = -1.4
    world = make_world(name, fixed_base=True)
    world.reset(pose[None])
    apart = []
    for tick in range(60):
        command = pose.copy()
        command[[first, second]] = -0.3 * np.sin(0.2 * tick)
        position = world.step(command[None]).position_rad[0]
        apart.append(abs(position[first] - position[second]))
    assert max(apart) < 2e-4


def test_the_load_is_uneven(nao):
    """Bare mechanics for the test above: what gravity asks of each hip yaw joint."""
    model = mujoco_model(nao, WorldOptions(fixed_base=True), ground=None)
    data = mujoco.MjData(model)
    data.joint("RHipPitch").qpos[0] = -1.4
    mujoco.mj_forward(model, data)
    first, second = nao.coupled[0]
    assert abs(data.qfrc_bias[first] - data.qfrc_bias[second]) > 0.5


@pytest.fixture(scope="module")
def states(nao, random_poses):
    """Random (position, velocity, command), away from the joints' ends."""
    generator = np.random.default_rng(31)
    low, high = nao.joint_range_rad.T
    rows = []
    for pose in random_poses(40, seed=32):
        position = (low + high) / 2 + 0.8 * (pose - (low + high) / 2)
        velocity = generator.uniform(-1.2, 1.2, 20) * nao.no_load_speed_rad_s
        command = position + generator.uniform(-0.3, 0.3, 20)
        for array in (position, velocity, command):
            array[nao.coupled[0][1]] = array[nao.coupled[0][0]]
        rows.append((position, velocity, command))
    return rows


def torque_line(nao, position, velocity, command):
    """The torque-speed line in closed form."""
    motors = [joint.motor for joint in nao.links]
    stall = np.array([motor.stall_torque_nm for motor in motors])
    kp = np.array([motor.kp_nm_rad for motor in motors])
    share = velocity / nao.no_load_speed_rad_s
    spring = np.clip(kp * (command - position), -stall, stall)
    return spring - stall * share


def test_twin_of_a_tiny_step_is_the_torque_line(nao, states):
    options = WorldOptions(timestep_s=1e-8, fixed_base=True)
    twin = ServoTwin(nao, options)
    for position, velocity, command in states:
        twin.reset()
        torque = twin.torque(*ROOT, position, velocity, command)
        expected = torque_line(nao, position, velocity, command)
        np.testing.assert_allclose(torque, expected, rtol=0, atol=1e-3)


def test_twin_of_a_usual_step_is_implicit_in_velocity(nao, states):
    """A stable PD in closed form: (M + h D) dv = h (tau - c), torque tau - D dv."""
    bare = replace(nao, coupled=())
    options = WorldOptions(timestep_s=0.002, fixed_base=True)
    twin, model = ServoTwin(bare, options), mujoco_model(bare, options, ground=None)
    data, mass = mujoco.MjData(model), np.zeros((20, 20))
    damping = np.diag([joint.motor.kd_nm_s_rad for joint in nao.links])
    for position, velocity, command in states:
        data.qpos[:], data.qvel[:] = position, velocity
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        explicit = torque_line(nao, position, velocity, command)
        change = np.linalg.solve(mass / 0.002 + damping, explicit - data.qfrc_bias)
        twin.reset()
        torque = twin.torque(*ROOT, position, velocity, command)
        np.testing.assert_allclose(
            torque, explicit - damping @ change, rtol=0, atol=1e-6
        )
        assert np.abs(torque - explicit).max() > 0.1


def test_twin_forgets_a_blow_up(nao, states):
    options = WorldOptions(fixed_base=True)
    fresh, used = ServoTwin(nao, options), ServoTwin(nao, options)
    bad = np.full(20, np.nan)
    assert not np.isfinite(used.torque(*ROOT, bad, bad, bad)).any()
    used.reset()
    for position, velocity, command in states[:3]:
        np.testing.assert_array_equal(
            used.torque(*ROOT, position, velocity, command),
            fresh.torque(*ROOT, position, velocity, command),
        )


def test_standing_robots_sag_alike(make_world, crouch):
    """Contact forces do not confuse the twin: at rest the joints agree to 0.5 mrad."""
    rest = []
    for name in ("sim", "real"):
        world = make_world(name)
        world.reset(crouch[None])
        for _ in range(200):
            observation = world.step(crouch[None])
        rest.append(observation.position_rad[0])
    sim, real = rest
    assert np.abs(sim - crouch).max() > 0.01
    assert np.abs(sim - real).max() < 5e-4
