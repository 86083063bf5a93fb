"""The feet that the commands put somewhere, found again by forward kinematics."""

import math

import numpy as np
import pytest
from walk_drill import Drill, feet_of

from walk_engine import Velocity, WalkEngine, gaits

WALK2014 = gaits.get("walk2014")
HIP_Y, HIP_Z, ANKLE = 0.05, -0.085, 0.04519


def walked(biped, gait, ticks, request=None, half_period_s=0.23):
    """Ankles and foot rotations of one robot, and which foot supported it."""
    drill = Drill(WalkEngine(biped, [gait]), half_period_s)
    commands = drill.run(ticks, request)[:, 0]
    return *feet_of(biped, commands), np.array(drill.supports)[:, 0]


def test_steady_feet_are_a_quarter_of_the_cycle_ahead_and_behind(unlimited):
    ankles, _, _ = walked(unlimited, WALK2014, 24 * 10)
    quarter, com = 0.3 * 2 * 0.23 / 4, 0.010
    for k in range(3, 9):  # the weight moves in ticks 23, 46, ...
        ends = sorted(ankles[23 * k, :, 0])
        assert np.allclose(ends, [-quarter - com, quarter - com], atol=1e-9)
        assert np.allclose(ankles[23 * k, :, 2], HIP_Z - (0.230 - ANKLE), atol=1e-9)


def test_feet_stay_below_the_hips_and_level_when_walking_straight(unlimited):
    ankles, turns, _ = walked(unlimited, WALK2014, 150)
    assert np.allclose(ankles[..., 1], [HIP_Y, -HIP_Y], atol=1e-9)
    assert np.allclose(turns, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("speed", [0.1, 0.25, -0.15])
def test_stance_foot_moves_at_the_commanded_speed(unlimited, speed):
    request = Velocity(forward_m_s=speed)
    ankles, _, support = walked(unlimited, WALK2014, 200, request)
    foot = np.where(support > 0, 0, 1)[:, None, None]
    x = np.take_along_axis(ankles, foot, axis=1)[:, 0, 0]
    within_step = np.ones(199, dtype=bool)
    # The foot that supports after the change was still swinging in that tick.
    within_step[np.flatnonzero(np.diff(support))] = False
    within_step[np.flatnonzero(np.diff(support)[:-1]) + 1] = False
    later = slice(60, None)
    velocity = (np.diff(x) / 0.01)[later][within_step[later]]
    assert len(velocity) > 100
    assert np.allclose(velocity, -speed, atol=1e-9)


def test_stance_foot_stays_down_while_the_swing_foot_rises_to_the_lift(unlimited):
    gait = WALK2014.replace(base_leg_lift=0.02, lift_slope_forward=0.1)
    ankles, _, _ = walked(unlimited, gait, 200)
    height = ankles[100:, :, 2] - (HIP_Z - (0.230 - ANKLE))
    # T = 0.23 s is 23 ticks: the tick next to the apex is 1/46 of the step off it.
    lift = 0.02 + 0.1 * 0.3 * 2 * 0.23
    apex = lift * (1 - 8 / 46**2)
    assert np.allclose(height.max(axis=0), apex, atol=1e-9)
    assert np.allclose(height.min(axis=1), 0.0, atol=1e-9)


def test_first_step_lifts_by_its_divisor_and_goes_nowhere(unlimited):
    gait = WALK2014.replace(lift_slope_forward=0.0, start_lift_divisor=2.0)
    ankles, _, _ = walked(unlimited, gait, 23)
    height = ankles[:, :, 2] - (HIP_Z - (0.230 - ANKLE))
    assert height.max() == pytest.approx(0.010 / 2 * (1 - 8 / 46**2), abs=1e-9)
    assert np.allclose(ankles[..., 0], -0.010, atol=1e-9)


@pytest.mark.parametrize("apex", [0.3, 0.7])
def test_swing_foot_is_highest_at_the_apex_phase(unlimited, apex):
    gait = WALK2014.replace(lift_apex_phase=apex, step_period=0.20)
    ankles, _, _ = walked(unlimited, gait, 200, half_period_s=0.20)
    step = ankles[121:141, :, 2]  # phases 1/20 to 20/20
    swing = np.argmax(np.ptp(step, axis=0))
    assert (np.argmax(step[:, swing]) + 1) / 20 == pytest.approx(apex)


def test_swing_foot_does_not_travel_in_its_dead_time(unlimited):
    gait = WALK2014.replace(swing_dead_fraction=0.4, step_period=0.20)
    ankles, _, support = walked(unlimited, gait, 200, half_period_s=0.20)
    swing = 1 if support[130] > 0 else 0
    x = ankles[120:141, swing, 0]  # 0.2 of the step dead at each end: 4 ticks
    assert np.allclose(x[:5], x[0], atol=1e-9)
    assert np.allclose(x[16:], x[-1], atol=1e-9)
    assert x[5] > x[0] + 1e-4


def test_hip_moves_ahead_with_the_speed(unlimited):
    gait = WALK2014.replace(com_offset=0.02, com_offset_speed_gain=0.012)
    for speed, offset in ((0.3, 0.032), (0.15, 0.026), (-0.15, 0.02)):
        ankles, _, _ = walked(unlimited, gait, 161, Velocity(forward_m_s=speed))
        assert ankles[23 * 6, :, 0].mean() == pytest.approx(-offset, abs=1e-9)


def test_torso_leans_forward_over_level_soles(unlimited):
    lean = 0.08
    gait = WALK2014.replace(torso_pitch=lean)
    ankles, turns, _ = walked(unlimited, gait, 150)
    upright, _, _ = walked(unlimited, WALK2014, 150)
    # Turning the torso forward (x to -z) carries its frame to the level one.
    level = np.array(
        [
            [math.cos(lean), 0, math.sin(lean)],
            [0, 1, 0],
            [-math.sin(lean), 0, math.cos(lean)],
        ]
    )
    assert np.allclose(level @ turns, np.eye(3), atol=1e-9)
    hips = np.array([[0, HIP_Y, HIP_Z], [0, -HIP_Y, HIP_Z]])
    assert np.allclose((ankles - hips) @ level.T, upright - hips, atol=1e-9)


@pytest.mark.parametrize("side", [1, -1])
def test_side_steps_open_and_close_the_feet(unlimited, side):
    period = 0.23 + 0.05 * 0.12 / 0.2  # a step to the side takes longer: 0.26 s
    request = Velocity(left_m_s=side * 0.12)
    ankles, turns, support = walked(unlimited, WALK2014, 26 * 8 + 1, request, period)
    way, height = 0.12 * 2 * period * 0.82, 0.230 - ANKLE
    wide = 2 * HIP_Y + 2 * height * math.tan(math.atan(way / height) / 2)
    for k in range(3, 8):
        distance = ankles[26 * k, 0, 1] - ankles[26 * k, 1, 1]
        # The foot on the side of the way has just come down if it supports now.
        opened = support[26 * k] == side
        assert distance == pytest.approx(wide if opened else 2 * HIP_Y, abs=1e-9)
        # At half time of the next step an opening foot has half its way behind it, a
        # closing one half of its angle.
        whole = math.atan(way / height) / 2
        half = whole / 2 if opened else math.atan(way / height / 2) / 2
        stance = 0 if support[26 * k] > 0 else 1
        aside = abs(ankles[26 * k + 13, stance, 1]) - HIP_Y
        assert aside == pytest.approx(height * math.tan(half), abs=1e-9)
    spread = (ankles[..., 1] - [HIP_Y, -HIP_Y]) / (HIP_Z - ankles[..., 2])
    assert np.allclose(spread[:, 0], -spread[:, 1], atol=1e-9)
    assert np.allclose(turns, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("rate", [0.6, -0.6])
def test_turning_without_slip_turns_at_the_commanded_rate(unlimited, rate):
    request = Velocity(turn_rad_s=rate)
    ankles, turns, support = walked(unlimited, WALK2014, 23 * 9, request)
    foot_yaw = np.arctan2(turns[:, :, 1, 0], turns[:, :, 0, 0])
    rows = np.arange(1, len(support))
    stance = np.where(support[:-1] > 0, 0, 1)  # the foot that stood during the tick
    torso = -(foot_yaw[rows, stance] - foot_yaw[rows - 1, stance])
    total = torso[23 * 2 : 23 * 8].sum()
    assert total == pytest.approx(rate * 6 * 0.23, rel=0.02)
    assert np.allclose(turns[..., 2], [0, 0, 1], atol=1e-9)
    assert np.allclose(ankles[..., 1], [HIP_Y, -HIP_Y], atol=1e-9)


def test_outer_foot_takes_two_thirds_of_a_turn(unlimited):
    drill = Drill(WalkEngine(unlimited, [WALK2014]))
    commands = drill.run(23 * 8 + 1, Velocity(turn_rad_s=0.6))[:, 0]
    whole = 0.6 * 2 * 0.23 / (2 * math.sqrt(0.5))
    ends = commands[[23 * 6, 23 * 7], 0]
    # A negative hip yaw turns both feet outward.
    assert sorted(ends) == pytest.approx([-0.67 * whole, 0.33 * whole], abs=1e-9)
    assert (commands[:, 0] == commands[:, 6]).all()


def test_arms_swing_against_the_foot_of_their_side(unlimited):
    gait = WALK2014.replace(arm_swing=8.0)
    drill = Drill(WalkEngine(unlimited, [gait]))
    commands = drill.run(150)[:, 0]
    ankles, _ = feet_of(unlimited, commands)
    behind = -(ankles[..., 0] + 0.010)
    expected = math.pi / 2 - 8.0 * behind
    assert np.allclose(commands[:, [12, 16]], expected, atol=1e-9)
    assert np.allclose(commands[:, [13, 17]], np.radians([7, -7]))


def test_other_joints_stay_next_to_zero(biped):
    commands = Drill(WalkEngine(biped, [WALK2014])).run(50)[:, 0]
    assert np.allclose(commands[:, [14, 15, 18, 19]], [0, -0.0349066, 0, 0.0349066])


def test_no_pose_jumps_from_tick_to_tick(unlimited):
    gait = WALK2014.replace(com_offset_speed_gain=0.03)
    drill = Drill(WalkEngine(unlimited, [gait]), half_period_s=0.19)
    for request in (
        Velocity(0.25, 0.1, 0.4),
        Velocity(-0.2, -0.1, -0.4),
        Velocity(),
        Velocity(stand=True),
        Velocity(0.2),
    ):
        drill.run(140, request)
    commands = np.array(drill.commands)[:, 0]
    # The quickest planned motion, the knee of the swing leg, makes 0.06 a tick.
    assert np.abs(np.diff(commands, axis=0)).max() < 0.12
