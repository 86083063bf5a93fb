"""Finds the cause of a robot's fall from the recording of its walk alone."""

import enum
import math
from dataclasses import dataclass

import numpy as np

from experiments.stress import fall_cause_events as events
from experiments.stress.fall_cause_signals import Signals
from worlds import End
from worlds.scenes.scene import Scene

LOSS_TILT_RAD = math.radians(15)
"""Tilt of the torso from the vertical [rad] from which no robot recovers; in walks
without a fall it stays below this limit."""

WINDOW_PENDULUMS = 6.0
"""Longest time from a cause to the loss of balance, in units of
sqrt(leg length / gravity): 0.95 s for the NAO, which is four steps."""


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
    Cause.SLIP: events.slip,
    Cause.TRIP: events.trip,
    Cause.MISSED_SWITCH: events.missed_switch,
    Cause.MOTOR_LIMIT: events.motor_limit,
}


@dataclass(frozen=True)
class FallCause:
    """The cause of a fall and its time.

    Attributes:
      cause: the cause.
      time_s: time in the recording [s] at which the cause was first detected; for a tip
        the time at which balance was lost; None if the cause is unknown.
    """

    cause: Cause
    time_s: float | None


def fall_cause(scene: Scene) -> FallCause:
    """Find the cause of a fall: the first event in the second before balance is lost.

    Events are a slip, a trip, a missed support switch and a motor at its limit. Without
    any event the robot tipped over a foot: sideways, forward or backward, by its lean
    at the end. The cause is unknown if the robot sank without leaning, or if the
    simulation diverged.

    Args:
      scene: a walk that ended with a fall. The recording must have base pose, commands,
        foot forces and support leg, and its metadata the servo of every joint.

    Raises:
      UnknownNameError: the recording lacks a column.
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
