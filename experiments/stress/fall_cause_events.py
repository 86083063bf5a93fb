"""Detectors of events that can make a walking robot fall.

Every function takes signals and a range of ticks, and returns the tick at which the
event happened first, or None. Lengths are in leg lengths and times in
sqrt(leg length / gravity), so that they fit robots of any size; values in brackets are
the NAO's. Each threshold lies between its values in walks without falls and in falls
that were made on purpose (docs/terrain_stress.md).
"""

import numpy as np

from experiments.stress.fall_cause_signals import Signals
from groundwalk.arrays import BoolArray, FloatArray
from robots import biped

LOADED = 0.3
"""Share of the robot's weight on a foot above which the foot counts as standing."""

_SHORT_S = 0.04
"""Time over which motion is measured [s]: shorter motion is below the resolution of the
encoders."""

SLIDE_LEGS, SLIDE_PENDULUMS = 0.06, 1.5
"""A standing foot slips if it slides this distance (15 mm) in this time (0.24 s)."""

_CREEP_LEGS = 0.002
"""Sliding by less than this in a tick (0.5 mm) is ignored: feet roll on their rims."""

TO_GO_LEGS, RISE_LEGS, AHEAD_LEGS = 0.02, 0.02, 0.05
"""Thresholds of a trip: the distance that the foot should still travel (5 mm), the
height of the ground above the sole (5 mm), its distance ahead of the sole (12 mm)."""

TOUCH, IN_THE_AIR = 0.2, 0.15
"""Shares of the weight above which a swing foot touches something, and below which it
is in the air."""

WRONG_SHARE, WRONG_PENDULUMS = 0.3, 0.6
"""A support switch is missed if the swing foot carries more of the weight than the
support foot, by this share, for this time (0.1 s). In a normal switch it does so for
0.03 s."""

SATURATED, SATURATED_PENDULUMS = 0.97, 0.8
"""A motor is at its limit if its servo asks for this share of the stall torque for this
time (0.13 s). In a normal step of a fast gait it does so for 0.1 s."""

LATENCY_S = 0.04
"""Longest time until a command takes effect [s]: a little over the real latency."""


def slip(signals: Signals, ticks: range) -> int | None:
    """Detect that a standing foot slides over the ground.

    Its sliding is the motion of its slowest point at or below the ground, because a
    foot that only tips or pivots has a point that rests.
    """
    step, window = (
        signals.ticks_in(_SHORT_S),
        signals.ticks_in(SLIDE_PENDULUMS * signals.pendulum_s),
    )
    moved_m = np.linalg.norm(
        signals.soles_m[step:, ..., :2] - signals.soles_m[:-step, ..., :2], axis=3
    )
    clearance_m = signals.clearance_m[step:]
    lowest_m = clearance_m.min(axis=2, keepdims=True)
    near = clearance_m < np.maximum(lowest_m + 0.01 * signals.leg_m, 0.0)
    rate_m = np.where(near, moved_m, np.inf).min(axis=2) / step
    stands = _all_of_last(signals.load > LOADED, step + 1)[step:]
    slides = stands & (rate_m > _CREEP_LEGS * signals.leg_m)
    way_m = np.cumsum(np.where(slides, rate_m, 0.0), axis=0)
    way_m[window:] -= way_m[:-window].copy()
    slipped = (way_m > SLIDE_LEGS * signals.leg_m).any(axis=1)
    return _first(np.concatenate([np.zeros(step, bool), slipped]), ticks)


def trip(signals: Signals, ticks: range) -> int | None:
    """Detect that the swing foot hits a rise of the ground and stops too early."""
    step = signals.ticks_in(_SHORT_S)
    was_in_air = _all_of_last(signals.load < IN_THE_AIR, 3)
    for tick in ticks:
        if not 2 * step < tick < len(signals.load) - step:
            continue
        for side in (0, 1):
            touches = signals.load[tick, side] > TOUCH and was_in_air[tick - 1, side]
            if touches and signals.swings[tick - 2, side]:
                stopped = _stops(signals, tick, side, step)
                if stopped and _faces_a_rise(signals, tick, side):
                    return tick
    return None


def _stops(signals: Signals, tick: int, side: int, step: int) -> bool:
    """Whether a foot loses half of its speed at a tick, before it is at its target."""
    heading = signals.heading[tick]
    sole_m = signals.soles_m[:, side, :, :2].mean(axis=1) @ heading
    goal_m = signals.commanded_m[tick - 1, side, :, :2].mean(axis=0) @ heading
    before_m = sole_m[tick - 1] - sole_m[tick - 1 - step]
    after_m = sole_m[tick + step] - sole_m[tick]
    to_go_m = goal_m - sole_m[tick - 1]
    return bool(to_go_m > TO_GO_LEGS * signals.leg_m and 2 * after_m < before_m)


def _faces_a_rise(signals: Signals, tick: int, side: int) -> bool:
    """Whether the ground just ahead of a sole's point stands above that point."""
    points_m = signals.soles_m[tick, side]
    ahead_m = points_m[:, :2] + AHEAD_LEGS * signals.leg_m * signals.heading[tick]
    above_m = signals.ground_m(ahead_m) - points_m[:, 2]
    return bool(above_m.max() > RISE_LEGS * signals.leg_m)


def missed_switch(signals: Signals, ticks: range) -> int | None:
    """Detect that the weight stays on the foot that the walk engine wants to swing."""
    extra = np.where(signals.swings, signals.load - signals.load[:, ::-1], 0.0)
    wrong = np.asarray((extra > WRONG_SHARE).any(axis=1))
    long = signals.ticks_in(WRONG_PENDULUMS * signals.pendulum_s)
    return _first(_all_of_last(wrong, long), ticks)


def motor_limit(signals: Signals, ticks: range) -> int | None:
    """Detect that a motor of a standing leg is at its limit while its error grows.

    If the position error exceeds stall torque / kp, the servo asks for all the torque
    that the motor can give at its speed (see `Motor`). Because of the latency the
    command in effect may be any of the last few.
    """
    long = signals.ticks_in(SATURATED_PENDULUMS * signals.pendulum_s)
    asked = asked_share(signals)
    grows = np.zeros_like(asked, dtype=bool)
    grows[long:] = asked[long:] > asked[:-long]
    at_limit = _all_of_last(asked > SATURATED, long) & grows
    legs = biped(signals.scene.description)
    stands = signals.load > LOADED
    left, right = (
        at_limit[:, list(leg)].any(axis=1) for leg in (legs.left_leg, legs.right_leg)
    )
    return _first((left & stands[:, 0]) | (right & stands[:, 1]), ticks)


def asked_share(signals: Signals) -> FloatArray:
    """(ticks, joints) smallest torque that any recent command asks for, over stall."""
    recording, robot = signals.scene.recording, signals.scene.description
    commands = recording.commands(robot.joints)
    servo = [recording.metadata.servo[joint] for joint in robot.joints]
    scale = np.array([gains.kp / gains.max_torque for gains in servo])
    late = np.arange(signals.ticks_in(LATENCY_S) + 1)
    rows = np.maximum(np.arange(len(commands)) - late[:, None], 0)
    error = scale * (commands[rows] - recording.positions(robot.joints))
    agree = (np.sign(error) == np.sign(error[0])).all(axis=0)
    return np.where(agree, np.abs(error).min(axis=0), 0.0)


def _all_of_last(mask: BoolArray, count: int) -> BoolArray:
    """Whether a mask (ticks, ...) was set at each of the last `count` ticks."""
    every = mask.copy()
    for back in range(1, count):
        every[back:] &= mask[:-back]
        every[:back] = False
    return every


def _first(mask: BoolArray, ticks: range) -> int | None:
    """The first tick of a range at which a mask (ticks,) is set."""
    found = np.flatnonzero(mask[ticks.start : ticks.stop])
    return ticks.start + int(found[0]) if found.size else None
