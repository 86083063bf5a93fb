"""Finds the cause of a robot's fall from the recording of its walk alone.

Each detector of an event takes the signals of a walk and a range of ticks, and returns
the first tick at which the event happened, or None. Thresholds are in leg lengths and
in sqrt(leg length / gravity), so that they fit robots of any size; values in
parentheses are the NAO's. Each threshold lies between the values in walks without falls
and those in falls that were caused on purpose (docs/terrain_stress.md).
"""

import enum
import math
from typing import NamedTuple

import numpy as np

from experiments.stress.fall_cause_signals import Signals
from groundwalk.arrays import BoolArray, FloatArray
from robots import biped
from worlds import End
from worlds.scenes.scene import Scene

LOSS_TILT_RAD = math.radians(15)
"""Tilt of the torso from the vertical [rad] from which no robot recovers; in walks
without a fall it stays below this limit."""

WINDOW_PENDULUMS = 6.0
"""Longest time from a cause to the loss of balance, in units of
sqrt(leg length / gravity): 0.95 s for the NAO, which is four steps."""

LOADED = 0.3
"""A foot that carries more than this share of the robot's weight counts as standing."""

_SHORT_S = 0.04
"""Time over which the motion of a foot is measured [s]: in a shorter time the motion is
below the resolution of the encoders."""

SLIDE_LEGS, SLIDE_PENDULUMS = 0.06, 1.5
"""Thresholds of a slip: a standing foot slides by this distance [leg lengths] (15 mm)
within this time [sqrt(leg length / gravity)] (0.24 s)."""

_CREEP_LEGS = 0.002
"""Sliding of a foot by less than this in a tick [leg lengths] (0.5 mm) is ignored,
because feet roll on their rims."""

TO_GO_LEGS, RISE_LEGS, AHEAD_LEGS = 0.02, 0.02, 0.05
"""Thresholds of a trip [leg lengths]: the distance that the foot should still travel
(5 mm), and the height above the sole (5 mm) of the ground at a distance ahead of the
sole (12 mm)."""

TOUCH, IN_THE_AIR = 0.2, 0.15
"""Thresholds of a trip, as shares of the robot's weight: a swing foot with a larger
force than the first touches something, one with less than the second is in the air."""

WRONG_SHARE, WRONG_PENDULUMS = 0.3, 0.6
"""Thresholds of a missed support switch: the swing foot carries more than the support
foot, by this share of the robot's weight, for this time [sqrt(leg length / gravity)]
(0.1 s). In a normal switch it does so for 0.03 s."""

SATURATED, SATURATED_PENDULUMS = 0.97, 0.8
"""Thresholds of a motor at its limit: its servo asks for this share of the stall torque
for this time [sqrt(leg length / gravity)] (0.13 s). In a normal step of a fast gait it
does so for 0.1 s."""

LATENCY_S = 0.04
"""Longest time until a command takes effect [s], a little above the command latency of
the real world."""


def slip(signals: Signals, ticks: range) -> int | None:
    """Detect that a standing foot slides over the ground.

    The slowest of the sole's points on the ground gives the speed of sliding, because
    a foot that only tips or pivots has a point at rest.
    """
    step = signals.ticks_in(_SHORT_S)
    window = signals.ticks_in(SLIDE_PENDULUMS * signals.pendulum_s)
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
    """Detect that the swing foot hits rising ground and stops before its target."""
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
    """Whether a foot loses half of its speed at a tick before it reaches its target."""
    heading = signals.heading[tick]
    sole_m = signals.soles_m[:, side, :, :2].mean(axis=1) @ heading
    goal_m = signals.commanded_m[tick - 1, side, :, :2].mean(axis=0) @ heading
    before_m = sole_m[tick - 1] - sole_m[tick - 1 - step]
    after_m = sole_m[tick + step] - sole_m[tick]
    to_go_m = goal_m - sole_m[tick - 1]
    return bool(to_go_m > TO_GO_LEGS * signals.leg_m and 2 * after_m < before_m)


def _faces_a_rise(signals: Signals, tick: int, side: int) -> bool:
    """Whether the ground just ahead of a point of a sole is higher than this point."""
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
    that the motor can give at its speed. Because of the command latency, any of the
    commands of the last 0.04 s may be in effect.
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
    """(ticks, joints) torque that commands ask for, as a share of the stall torque.

    Because of the latency, it is the minimum over the commands of the last 0.04 s; it
    is 0 where these ask for torques of different signs.
    """
    recording, robot = signals.scene.recording, signals.scene.description
    commands = recording.joint_values("command", robot.joints)
    servo = [recording.metadata.servo[joint] for joint in robot.joints]
    scale = np.array([gains.kp / gains.max_torque for gains in servo])
    late = np.arange(signals.ticks_in(LATENCY_S) + 1)
    rows = np.maximum(np.arange(len(commands)) - late[:, None], 0)
    error = scale * (commands[rows] - recording.joint_values("position", robot.joints))
    agree = (np.sign(error) == np.sign(error[0])).all(axis=0)
    return np.where(agree, np.abs(error).min(axis=0), 0.0)


def _all_of_last(mask: BoolArray, count: int) -> BoolArray:
    """(ticks, ...) whether a mask was true at each of the last `count` ticks."""
    every = mask.copy()
    for back in range(1, count):
        every[back:] &= mask[:-back]
        every[:back] = False
    return every


def _first(mask: BoolArray, ticks: range) -> int | None:
    """The first tick in a range at which a mask (ticks,) is true; None if never."""
    found = np.flatnonzero(mask[ticks.start : ticks.stop])
    return ticks.start + int(found[0]) if found.size else None


class Cause(enum.StrEnum):
    """Cause of a fall: the first event before it, or else the direction of tipping."""

    SLIP = "slip"
    TRIP = "trip"
    MISSED_SWITCH = "missed support switch"
    MOTOR_LIMIT = "motor limit"
    SIDEWAYS_TIP = "sideways tip"
    FORWARD_TIP = "forward tip"
    BACKWARD_TIP = "backward tip"
    UNKNOWN = "unknown"


_EVENTS = {
    Cause.SLIP: slip,
    Cause.TRIP: trip,
    Cause.MISSED_SWITCH: missed_switch,
    Cause.MOTOR_LIMIT: motor_limit,
}


class FallCause(NamedTuple):
    """The cause of a fall, and the time [s] in the recording when it first showed.

    If the robot just tipped over, it is the time at which balance was lost; None if the
    cause is unknown.
    """

    cause: Cause
    time_s: float | None


def fall_cause(scene: Scene) -> FallCause:
    """Find the cause of a fall: the first event in the second before balance is lost.

    Events are a slip, a trip, a missed support switch and a motor at its limit. Without
    any event the robot tipped over a foot: sideways, forward or backward, by its lean
    at the end. The cause is unknown if the robot sank without leaning, or if the
    simulation diverged.

    The recording must have base pose, commands, foot forces and support leg (an
    UnknownNameError says what it lacks), and its metadata the servo of every joint.
    """
    if scene.recording.metadata.end == End.DIVERGED:
        return FallCause(Cause.UNKNOWN, None)
    signals = Signals(scene)
    loss = _loss(signals)
    window = signals.ticks_in(WINDOW_PENDULUMS * signals.pendulum_s)
    before = range(max(0, loss - window), loss)
    found = [
        (tick, cause)
        for cause, event in _EVENTS.items()
        if (tick := event(signals, before)) is not None
    ]
    if found:
        tick, cause = min(found, key=lambda entry: entry[0])
        return FallCause(cause, float(signals.time_s[tick]))
    if loss == len(signals.tilt_rad):
        return FallCause(Cause.UNKNOWN, None)
    forward, left = signals.lean[-1]
    tip = Cause.FORWARD_TIP if forward > 0 else Cause.BACKWARD_TIP
    if abs(left) > abs(forward):
        tip = Cause.SIDEWAYS_TIP
    return FallCause(tip, float(signals.time_s[loss]))


def _loss(signals: Signals) -> int:
    """The tick from which on the torso is tilted too far; number of ticks if never."""
    upright = np.flatnonzero(signals.tilt_rad < LOSS_TILT_RAD)
    return int(upright[-1]) + 1 if upright.size else 0
