import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robots
import terrain
import worlds
from sgat.walks.walk_senses import HISTORY_TICKS, WalkSenses, tilted
from walk_engine import Velocity, WalkEngine, gaits
from worlds import TICK_S, Observation

JOINTS = [7, 2, 11]
UPRIGHT = np.array([[0.0, 0.0, 1.0]])
SILENT = np.zeros((1, 3))


def observation(rng, n=2, joints=20):
    """Made-up readings, all different."""
    return Observation(
        time_s=np.zeros(n),
        position_rad=rng.normal(size=(n, joints)),
        velocity_rad_s=rng.normal(size=(n, joints)),
        gyroscope_rad_s=rng.normal(size=(n, 3)),
        accelerometer_m_s2=rng.normal([0, 0, 9.81], size=(n, 3)),
        foot_force_n=rng.normal(size=(n, 8)),
    )


def angle_rad(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b)), np.sum(a * b))


@pytest.mark.parametrize("direction", [[1, 0, 0], [0, 1, 0], [0.6, -0.8, 0]])
def test_turning_without_an_accelerometer_is_a_rotation(direction):
    rate = np.array([direction]) * 0.8
    up = UPRIGHT
    for _ in range(100):
        up = tilted(up, rate, SILENT)
    # what is fixed in the world turns backwards in the torso
    whole = Rotation.from_rotvec(-rate[0] * 100 * TICK_S).apply(UPRIGHT)
    assert up == pytest.approx(whole, abs=1e-4)
    forward = Rotation.from_rotvec(rate[0] * 100 * TICK_S).apply(UPRIGHT)
    assert angle_rad(up, forward) > 1.5


def test_turning_about_the_vertical_is_no_tilt():
    assert tilted(UPRIGHT, np.array([[0, 0, 5.0]]), SILENT).tolist() == [[0, 0, 1]]


def tilt_left(ticks, strength=9.81):
    """Share of a small tilt that a still robot's filter has not yet found."""
    tilt_rad = 0.05
    felt = np.array([[np.sin(tilt_rad), 0, np.cos(tilt_rad)]])
    up = UPRIGHT
    for _ in range(ticks):
        up = tilted(up, SILENT, strength * felt)
    return angle_rad(up, felt) / tilt_rad


def test_a_still_robot_finds_its_tilt_within_seconds():
    assert tilt_left(500) == pytest.approx(np.exp(-1), rel=0.02)
    assert tilt_left(1000) == pytest.approx(np.exp(-2), rel=0.03)
    assert tilt_left(250) > 1.5 * np.exp(-1)
    assert tilt_left(5000) < 1e-4


def test_the_accelerometer_counts_by_its_direction_alone():
    assert tilt_left(50, strength=100) == pytest.approx(tilt_left(50), rel=1e-9)
    assert tilt_left(50, strength=0) == 1


def test_the_up_axis_keeps_its_length():
    rng = np.random.default_rng(0)
    up = np.tile(UPRIGHT, (50, 1))
    for _ in range(200):
        up = tilted(up, 10 * rng.normal(size=(50, 3)), 20 * rng.normal(size=(50, 3)))
        assert np.linalg.norm(up, axis=1) == pytest.approx(1, abs=1e-12)


@pytest.fixture(scope="module")
def walk():
    """Observations of 3 s in the sim, and the true up axes (ticks, 3)."""
    description = robots.get("nao")
    ground, seed = terrain.make("flat", 0), np.random.SeedSequence(1)
    world = worlds.make("sim", description, [ground], [seed], worlds.WorldOptions())
    engine = WalkEngine(robots.biped(description), [gaits.get("start")], TICK_S)
    seen, up = [world.reset(engine.start_pose())], [UPRIGHT[0]]
    for _ in range(300):
        now = seen[-1]
        command = engine.step(Velocity.forward(), now.gyroscope_rad_s, now.foot_force_n)
        seen.append(world.step(command))
        w, *xyz = world.truth().base_orientation[0]
        up.append(Rotation.from_quat([*xyz, w]).inv().apply(UPRIGHT[0]))
    assert world.active.all()
    return seen, np.array(up)


def roll_error(walk, sign):
    """Error of the sideways tilt by the gyroscope alone, relative to the tilt."""
    senses, found = WalkSenses(JOINTS), []
    for now in walk[0]:
        now = dataclasses.replace(
            now,
            gyroscope_rad_s=sign * now.gyroscope_rad_s,
            accelerometer_m_s2=SILENT,
        )
        senses.observe(now) if found else senses.reset(now)
        found.append(senses.outcome()[0, -1])
    true = walk[1][:, 1]
    return np.std(found - true) / np.std(true)


def test_the_gyroscope_tells_how_a_walking_robot_sways(walk):
    assert roll_error(walk, 1) < 0.1
    assert roll_error(walk, -1) > 1


def test_what_the_columns_of_a_state_are():
    rng = np.random.default_rng(1)
    senses = WalkSenses(JOINTS)
    seen = [observation(rng) for _ in range(8)]
    commands = [rng.normal(size=(2, 20)) for _ in range(7)]
    senses.reset(seen[0])
    for command, now in zip(commands, seen[1:], strict=True):
        senses.remember(command)
        senses.observe(now)
    state = senses.state()
    here = seen[-1].position_rad[:, JOINTS]
    j = len(JOINTS)
    assert state.shape == (2, 5 + 2 * j + (HISTORY_TICKS - 1) * j)
    assert senses.outcomes == j + 5
    assert senses.sim_columns == 2 * j + 5
    assert (state[:, :j] == here).all()
    assert (state[:, j : j + 3] == seen[-1].gyroscope_rad_s).all()
    assert (state[:, : senses.outcomes] == senses.outcome()).all()
    last_change = here - seen[-2].position_rad[:, JOINTS]
    assert (state[:, senses.outcomes : senses.sim_columns] == last_change).all()
    past = state[:, senses.sim_columns :].reshape(2, HISTORY_TICKS - 1, j)
    for k, command in enumerate(commands[-(HISTORY_TICKS - 1) :]):
        assert (past[:, k] == command[:, JOINTS] - here).all()
    # the oldest first: the other way round it would be wrong
    assert (past[:, 0] != commands[-1][:, JOINTS] - here).all()


def test_a_state_follows_from_the_one_before_and_what_came_of_it():
    rng = np.random.default_rng(6)
    senses = WalkSenses(JOINTS)
    senses.reset(observation(rng))
    for _ in range(HISTORY_TICKS + 1):
        state, command = senses.state(), rng.normal(size=(2, 20))
        action = senses.action(command)
        senses.remember(command)
        senses.observe(observation(rng))
        later = senses.advanced(state, action, senses.outcome())
        np.testing.assert_allclose(later, senses.state(), atol=1e-12)
    other = senses.advanced(state, action + 0.1, senses.outcome())
    assert (np.abs(other - senses.state()).max(axis=1) > 0.09).all()


def test_the_tilt_is_in_the_state():
    senses = WalkSenses(JOINTS)
    now = observation(np.random.default_rng(2))
    senses.reset(now)
    up = tilted(np.tile(UPRIGHT, (2, 1)), now.gyroscope_rad_s, now.accelerometer_m_s2)
    assert (senses.state()[:, 6:8] == up[:, :2]).all()
    senses.observe(now)
    assert (senses.state()[:, 6:8] != up[:, :2]).all()


def test_a_start_has_no_past():
    rng = np.random.default_rng(3)
    senses = WalkSenses(JOINTS)
    first, second = observation(rng), observation(rng)
    senses.reset(first)
    fresh = senses.state()
    assert (fresh[:, senses.outcomes :] == 0).all()
    senses.remember(rng.normal(size=(2, 20)))
    senses.observe(second)
    assert (senses.state()[:, senses.outcomes :] != 0).any(axis=1).all()
    senses.reset(first)
    assert (senses.state() == fresh).all()


def test_an_action_becomes_the_command_that_it_came_from():
    rng = np.random.default_rng(4)
    senses = WalkSenses(JOINTS)
    senses.reset(observation(rng))
    command = rng.normal(size=(2, 20))
    kept = command.copy()
    action = senses.action(command)
    assert senses.command(action, command) == pytest.approx(command, abs=1e-14)
    shifted = senses.command(action + 0.1, command)
    others = [k for k in range(20) if k not in JOINTS]
    assert shifted[:, JOINTS] == pytest.approx(command[:, JOINTS] + 0.1, abs=1e-14)
    assert (shifted[:, others] == command[:, others]).all()
    assert (command == kept).all()


def test_an_action_is_relative_to_where_the_joints_are_now():
    now = observation(np.random.default_rng(5))
    senses = WalkSenses(JOINTS)
    senses.reset(now)
    assert (senses.action(now.position_rad) == 0).all()
    moved = dataclasses.replace(now, position_rad=now.position_rad + 0.25)
    senses.observe(moved)
    assert senses.action(now.position_rad) == pytest.approx(-0.25)
