"""The engine as a whole: parameters, symmetry, independence, bad input."""

from dataclasses import replace

import numpy as np
import pytest
from walk_drill import LEFT, RIGHT, Drill, forces

from groundwalk.errors import BadValueError
from walk_engine import Velocity, WalkEngine, gaits
from walk_engine.gait import NAMES, from_unit

WALK2014 = gaits.get("walk2014")
TURNING = np.array([[0.3, 0.5, 0.0]])

CHANGED = {
    "step_period": 0.25,
    "hip_height": 0.22,
    "max_forward": 0.2,
    "com_offset": 0.015,
    "com_offset_speed_gain": 0.01,
    "base_leg_lift": 0.015,
    "lift_slope_forward": 0.05,
    "lift_apex_phase": 0.4,
    "swing_dead_fraction": 0.2,
    "start_lift_divisor": 2.0,
    "arm_swing": 8.0,
    "gyro_sagittal": 0.06,
    "gyro_filter": 0.4,
    "gyro_coronal": 0.03,
    "switch_min_phase": 0.95,
    "torso_pitch": 0.05,
}


def walked(biped, gait, ticks=120):
    drill = Drill(WalkEngine(biped, [gait]), half_period_s=0.20)
    return drill.run(ticks, gyroscope=TURNING)


@pytest.mark.parametrize("name", NAMES)
def test_every_parameter_changes_the_walk(biped, name):
    base = walked(biped, WALK2014)
    changed = walked(biped, WALK2014.replace(**{name: CHANGED[name]}))
    assert np.abs(base - changed).max() > 1e-3


def test_the_same_gait_walks_the_same(biped):
    assert np.array_equal(walked(biped, WALK2014), walked(biped, WALK2014.replace()))


def random_walk(biped, which, ticks=160, active=None):
    """Commands (ticks, robots, joints) of some of 150 robots that share nothing."""
    rng = np.random.default_rng(11)
    vectors = from_unit(rng.random((150, 16)))
    forward, left = rng.uniform(-0.3, 0.4, 150), rng.uniform(-0.2, 0.2, 150)
    turn, stand = rng.uniform(-0.8, 0.8, 150), rng.random(150) < 0.1
    phase = rng.uniform(0, 2 * np.pi, 150)
    engine = WalkEngine(biped, vectors[which])
    commands = []
    for tick in range(ticks):
        rates = rng.normal(0, 0.5, (150, 3))
        share = 0.5 + 0.5 * np.sin(phase + tick * 0.01 * np.pi / 0.22)
        weight = np.repeat(np.stack((share, 1 - share), axis=1), 4, axis=1)
        force_n = 12 * weight * rng.uniform(0.5, 1.5, (150, 8))
        request = Velocity(forward[which], left[which], turn[which], stand[which])
        takes_part = None if active is None else active(tick)[which]
        commands.append(engine.step(request, rates[which], force_n[which], takes_part))
    return np.array(commands)


@pytest.fixture(scope="module")
def all_walks(biped):
    return random_walk(biped, np.arange(150))


@pytest.mark.parametrize(
    "which", [[0], [149], [3, 77], [5, 4, 3, 90, 91, 92, 149]], ids=len
)
def test_a_robot_walks_the_same_bits_in_any_batch(biped, all_walks, which):
    alone = random_walk(biped, np.array(which))
    assert np.array_equal(alone, all_walks[:, which])


def test_robots_of_a_batch_differ(all_walks):
    assert np.abs(all_walks[:, 0] - all_walks[:, 1]).max() > 0.05


def test_inactive_robots_keep_their_command_and_their_time(biped, all_walks):
    def active(tick):
        return np.arange(150) >= (tick >= 40) * 60

    commands = random_walk(biped, np.arange(150), active=active)
    assert (commands[40:, :60] == commands[39, :60]).all()
    assert np.array_equal(commands[:, 60:], all_walks[:, 60:])


def test_an_inactive_tick_is_as_if_it_had_not_been(biped):
    paused, plain = (WalkEngine(biped, [WALK2014]) for _ in range(2))
    for tick in range(100):
        side = RIGHT if tick % 46 < 23 else LEFT
        if tick % 7 == 0:
            nobody = np.array([False])
            paused.step(Velocity(), np.ones((1, 3)), forces(-side), nobody)
        command = paused.step(Velocity.forward(), TURNING, forces(side))
        expected = plain.step(Velocity.forward(), TURNING, forces(side))
        assert np.array_equal(command, expected)


def test_reset_forgets_everything(biped):
    engine = WalkEngine(biped, [WALK2014])
    first = Drill(engine).run(77, gyroscope=TURNING)
    engine.reset()
    assert np.array_equal(Drill(engine).run(77, gyroscope=TURNING), first)


def mirrored_joints(commands):
    flip = [1, -1, 1, 1, 1, -1]
    arm = [1, -1, -1, -1]
    order = [*range(6, 12), *range(6), *range(16, 20), *range(12, 16)]
    return commands[..., order] * np.array(flip * 2 + arm * 2)


def both_ways(biped, seed):
    """The same random walk twice, the second time in a mirror."""
    rng = np.random.default_rng(seed)
    vectors = from_unit(rng.random((8, 16)))
    engines = [WalkEngine(biped, vectors, first_swing=f) for f in ("left", "right")]
    results = []
    for tick in range(250):
        if tick % 50 == 0:
            wish = rng.uniform(-1, 1, (3, 8)) * [[0.4], [0.2], [0.8]]
        rates = rng.normal(0, 0.5, (8, 3))
        share = 0.5 + 0.5 * np.sin(tick * 0.01 * np.pi / 0.22)
        weight = np.repeat([share, 1 - share], 4)
        force_n = 12 * weight * rng.uniform(0.5, 1.5, (8, 8))
        results.append(
            (
                engines[0].step(Velocity(*wish), rates, force_n),
                engines[1].step(
                    Velocity(wish[0], -wish[1], -wish[2]),
                    rates * [-1, 1, -1],
                    force_n[:, [5, 4, 7, 6, 1, 0, 3, 2]],
                ),
            )
        )
        assert (engines[0].support == -engines[1].support).all()
    return np.array(results).swapaxes(0, 1)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_mirrored_world_gets_mirrored_commands(biped, seed):
    seen, mirrored = both_ways(biped, seed)
    assert np.allclose(mirrored, mirrored_joints(seen), atol=1e-12, rtol=0)
    assert not np.allclose(mirrored, seen, atol=1e-3)


def test_start_pose_is_the_first_command_of_a_robot_that_waits(biped):
    engine = WalkEngine(biped, [WALK2014])
    pose = engine.start_pose()
    # Published for hips at 0.230 m and an offset of 0.010 m.
    expected = [0, 0, -0.3746, 0.8446, -0.4699, 0]
    assert np.allclose(pose[0, :12], expected * 2, atol=5.1e-5)
    assert np.array_equal(engine.step(Velocity(), np.zeros((1, 3)), forces(0)), pose)


def test_returned_arrays_are_the_callers(biped):
    engine, other = (WalkEngine(biped, [WALK2014]) for _ in range(2))
    for tick in range(30):
        command = engine.step(Velocity.forward(), TURNING, forces(RIGHT))
        expected = other.step(Velocity.forward(), TURNING, forces(RIGHT))
        assert np.array_equal(command, expected), tick
        command[:] = 99.0
        engine.state[:] = 0


def test_a_robot_without_arms_walks(unlimited):
    armless = replace(unlimited, left_arm=None, right_arm=None)
    legs = Drill(WalkEngine(armless, [WALK2014])).run(60)
    with_arms = Drill(WalkEngine(unlimited, [WALK2014])).run(60)
    assert np.array_equal(legs[..., :12], with_arms[..., :12])
    assert (legs[..., 12:] == 0).all()


def test_a_vertical_yaw_axis_turns_the_same_way(unlimited):
    leg = replace(unlimited.leg, yaw_axis=(0.0, 0.0, 1.0))
    upright = replace(unlimited, leg=leg)
    commands = Drill(WalkEngine(upright, [WALK2014])).run(47, Velocity(0, 0, 0.5))
    # The left foot swings in the first step, so it is the outer one in the third.
    assert commands[-1, 0, 0] == pytest.approx(-0.33 * 0.5 * 0.46 / 2)


@pytest.mark.parametrize(
    ("name", "shape"), [("gyroscope_rad_s", (3,)), ("foot_force_n", (1, 4))]
)
def test_arrays_of_another_shape_are_refused(biped, name, shape):
    engine = WalkEngine(biped, [WALK2014])
    arrays = {"gyroscope_rad_s": np.zeros((1, 3)), "foot_force_n": np.zeros((1, 8))}
    engine.step(Velocity(), **arrays)
    with pytest.raises(BadValueError, match=name):
        engine.step(Velocity(), **{**arrays, name: np.zeros(shape)})


def test_requests_and_masks_of_another_shape_are_refused(biped):
    engine = WalkEngine(biped, [WALK2014] * 2)
    rates, force_n = np.zeros((2, 3)), np.zeros((2, 8))
    with pytest.raises(BadValueError, match=r"left_m_s has shape \(3,\)"):
        engine.step(Velocity(left_m_s=np.zeros(3)), rates, force_n)
    with pytest.raises(BadValueError, match="active"):
        engine.step(Velocity(), rates, force_n, np.array([True]))


@pytest.mark.parametrize("tick_s", [0.0, -0.01, np.nan, np.inf])
def test_bad_ticks_are_refused(biped, tick_s):
    with pytest.raises(BadValueError, match="tick"):
        WalkEngine(biped, [WALK2014], tick_s)


def test_bad_first_foot_is_refused(biped):
    with pytest.raises(BadValueError, match="first_swing"):
        WalkEngine(biped, [WALK2014], first_swing="middle")


@pytest.mark.parametrize("name", ["forward_m_s", "left_m_s", "turn_rad_s"])
def test_requests_that_are_no_numbers_are_refused(name):
    with pytest.raises(BadValueError, match=name):
        Velocity(**{name: np.array([0.0, np.nan])})
