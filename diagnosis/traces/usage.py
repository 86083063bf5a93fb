"""Measures the range, speed and torque that each joint used in some recordings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

_MOST = 0.99
"""Quantile that is taken for the largest torque, so that single outliers do not
count."""

_APART = 2
"""Half width [rows] of the central difference by which velocities are estimated."""

_LASTS_S = 0.02
"""Time [s] for which a joint must have a speed that counts as its highest: shorter ones
are noise."""


Ripple = tuple[float, float, float]
"""Size [N m], waves per turn and phase [rad] of a torque that repeats with an angle."""


@dataclass(frozen=True, eq=False)
class Usage:
    """The range, speed and torque that each of j joints used, arrays (j,).

    Attributes:
      low_rad: smallest position.
      high_rad: largest position.
      top_speed_rad_s: highest speed of the joint itself, on average over 20 ms.
      torque_nm: 99 % of the nominal servos' torques are below it.
      ripples: for joints by name the ripples that their torques show most, the first
        most; empty if nobody looked for any.
    """

    low_rad: FloatArray
    high_rad: FloatArray
    top_speed_rad_s: FloatArray
    torque_nm: FloatArray
    ripples: Mapping[str, tuple[Ripple, ...]] = field(default_factory=dict)

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Usage":
        """Measure how far, how fast and how hard each joint moves, over all traces."""
        position = np.concatenate([trace.position_rad for trace in traces])
        torques = [_servo_nm(trace) for trace in traces]
        tops = [_top_speed_rad_s(trace) for trace in traces]
        return cls(
            low_rad=np.nanmin(position, axis=0),
            high_rad=np.nanmax(position, axis=0),
            top_speed_rad_s=np.nanmax(tops, axis=0),
            torque_nm=np.nanquantile(np.concatenate(torques), _MOST, axis=0),
        )


def _servo_nm(trace: Trace) -> FloatArray:
    """(T, j) absolute torques [N m] that the servos ask for."""
    servo, position, command_rad = trace.servo, trace.position_rad, trace.command_rad
    if command_rad is None:
        command_rad = position
    rows = np.arange(len(position))
    before = np.maximum(rows - _APART, 0)
    after = np.minimum(rows + _APART, len(rows) - 1)
    lasted_s = (trace.time_s[after] - trace.time_s[before])[:, None]
    velocity = (position[after] - position[before]) / lasted_s
    return np.asarray(np.abs(servo.torque(command_rad - position, velocity)))


def _top_speed_rad_s(trace: Trace) -> FloatArray:
    """(j,) highest speeds [rad/s] at which joints moved for some time."""
    time_s, position = trace.time_s, trace.position_rad
    rows = max(round(_LASTS_S / trace.tick_s), 1)
    if len(time_s) <= rows:
        return np.zeros(position.shape[1])
    moved = np.abs(position[rows:] - position[:-rows])
    lasted_s = (time_s[rows:] - time_s[:-rows])[:, None]
    return np.asarray(np.nan_to_num(moved / lasted_s).max(axis=0))
