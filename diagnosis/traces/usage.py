"""Measures the range, speed and torque that each joint used in some recordings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

_MOST = 0.99
"""Quantile that is taken for the largest speed and torque, so that single outliers do
not count."""

_APART = 2
"""Half width [rows] of the central difference by which velocities are estimated."""


@dataclass(frozen=True, eq=False)
class Usage:
    """The range, speed and torque that each of j joints used, arrays (j,).

    Attributes:
      low_rad: smallest position.
      high_rad: largest position.
      command_speed_rad_s: 99 % of the commands' speeds are below it.
      torque_nm: 99 % of the nominal servos' torques are below it.
    """

    low_rad: FloatArray
    high_rad: FloatArray
    command_speed_rad_s: FloatArray
    torque_nm: FloatArray

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Usage":
        """Measure how far, how fast and how hard each joint moves, over all traces."""
        position = np.concatenate([trace.position_rad for trace in traces])
        speeds, torques = [], []
        for trace in traces:
            q, command = trace.position_rad, trace.command_rad
            command = q if command is None else command
            rate = np.abs(np.diff(command, axis=0) / np.diff(trace.time_s)[:, None])
            speeds.append(rate)
            torques.append(_servo_nm(trace, command))
        return cls(
            low_rad=np.nanmin(position, axis=0),
            high_rad=np.nanmax(position, axis=0),
            command_speed_rad_s=np.nanquantile(np.concatenate(speeds), _MOST, axis=0),
            torque_nm=np.nanquantile(np.concatenate(torques), _MOST, axis=0),
        )


def _servo_nm(trace: Trace, command_rad: FloatArray) -> FloatArray:
    """(T, j) absolute torques [N m] that the servos ask for with (T, j) commands."""
    servo, position = trace.servo, trace.position_rad
    rows = np.arange(len(position))
    before = np.maximum(rows - _APART, 0)
    after = np.minimum(rows + _APART, len(rows) - 1)
    lasted_s = (trace.time_s[after] - trace.time_s[before])[:, None]
    velocity = (position[after] - position[before]) / lasted_s
    return np.asarray(np.abs(servo.torque(command_rad - position, velocity)))
