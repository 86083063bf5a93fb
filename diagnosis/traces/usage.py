"""How much of itself each joint used in some traces."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

_MOST = 0.99
_APART = 2
"""Rows on both sides whose positions say how fast a joint goes."""


@dataclass(frozen=True, eq=False)
class Usage:
    """Of j joints, arrays (j,).

    Attributes:
      low_rad: least position.
      high_rad: largest position.
      command_speed_rad_s: that the commands seldom exceed.
      torque_nm: that the servos, as they should be, seldom exceed.
    """

    low_rad: FloatArray
    high_rad: FloatArray
    command_speed_rad_s: FloatArray
    torque_nm: FloatArray

    @classmethod
    def of(cls, plant: Plant, traces: Sequence[Trace]) -> "Usage":
        """Joint by joint over all traces."""
        position = np.concatenate([trace.position_rad for trace in traces])
        speeds, torques = [], []
        for trace in traces:
            command = trace.command_rad
            if command is None:
                command = trace.position_rad
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
    """(T, j) sizes of the torques that the servos should give."""
    servo, position = trace.servo, trace.position_rad
    rows = np.arange(len(position))
    before = np.maximum(rows - _APART, 0)
    after = np.minimum(rows + _APART, len(rows) - 1)
    lasted_s = (trace.time_s[after] - trace.time_s[before])[:, None]
    velocity = (position[after] - position[before]) / lasted_s
    torque = servo.kp_nm_rad * (command_rad - position) - servo.kd_nm_s_rad * velocity
    return np.asarray(np.minimum(np.abs(torque), servo.max_torque_nm))
