"""How much of itself each joint used in some traces."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.plant import Plant
from diagnosis.trace import Trace
from groundwalk.arrays import FloatArray

_MOST = 0.99


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
            error = np.abs(command - trace.position_rad) * trace.servo.kp_nm_rad
            speeds.append(rate)
            torques.append(np.minimum(error, trace.servo.max_torque_nm))
        return cls(
            low_rad=np.nanmin(position, axis=0),
            high_rad=np.nanmax(position, axis=0),
            command_speed_rad_s=np.nanquantile(np.concatenate(speeds), _MOST, axis=0),
            torque_nm=np.nanquantile(np.concatenate(torques), _MOST, axis=0),
        )
