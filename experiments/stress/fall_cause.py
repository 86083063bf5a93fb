"""What came before a fall, found from its recording alone."""

import enum
import math
from dataclasses import dataclass

import numpy as np

from experiments.stress import fall_cause_events as events
from experiments.stress.fall_cause_signals import Signals
from worlds import End
from worlds.scenes.scene import Scene

LOSS_TILT_RAD = math.radians(15)
"""Beyond this the torso does not come back: upright walks stay below."""

WINDOW_PENDULUMS = 6.0
"""How long before the loss of balance a cause may be, in sqrt(leg length / gravity);
0.95 s on the NAO, four steps."""


class Cause(enum.StrEnum):
    """What came first in the time before a fall."""

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
    """A cause and when it was.

    Attributes:
      cause: what.
      time_s: when it was first seen, in the recording's time; of a tip, when balance
        was lost; None if unknown.
    """

    cause: Cause
    time_s: float | None


def fall_cause(scene: Scene) -> FallCause:
    """The first event in the last second before the torso leaned too far to come back.

    Where there is none, the robot tipped over a foot: to the side, forward or backward,
    whichever it leans to most at the end. A robot that sank without leaning, or whose
    physics blew up, fell for unknown reasons.

    Args:
      scene: a walk that ended with a fall. The recording has base, commands, foot
        forces and support, and its metadata every joint's servo.

    Raises:
      UnknownNameError: a column is missing.
    """
    if scene.recording.metadata.end == End.DIVERGED:
        return FallCause(Cause.UNKNOWN, None)
    signals = Signals.of(scene)
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
    return FallCause(_tip(signals), float(signals.time_s[loss]))


def _loss(signals: Signals) -> int:
    """The tick from which on the torso leans too far; the number of ticks if never."""
    upright = np.flatnonzero(signals.tilt_rad < LOSS_TILT_RAD)
    return int(upright[-1]) + 1 if upright.size else 0


def _tip(signals: Signals) -> Cause:
    forward, left = signals.lean[-1]
    if abs(left) > abs(forward):
        return Cause.SIDEWAYS_TIP
    return Cause.FORWARD_TIP if forward > 0 else Cause.BACKWARD_TIP
