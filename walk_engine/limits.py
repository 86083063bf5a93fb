"""Limits of joint commands: the joints' ranges and their motors' speeds."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import Biped


@dataclass(frozen=True, eq=False)
class Limits:
    """Bounds of joint commands; all arrays are (joints, 1) [rad].

    Attributes:
      low_rad: lower ends of the joints' ranges.
      high_rad: upper ends of the joints' ranges.
      change_rad: largest change of a command from one tick to the next.
    """

    low_rad: FloatArray
    high_rad: FloatArray
    change_rad: FloatArray

    @classmethod
    def of(cls, biped: Biped, tick_s: float, speed_fraction: float) -> "Limits":
        """Compute the limits of a robot's joint commands.

        Args:
          biped: the robot.
          tick_s: duration of a control tick [s].
          speed_fraction: share of the motors' no-load speed that commands may use.
        """
        low, high = biped.joint_range_rad.T[:, :, None].copy()
        return cls(low, high, biped.max_speed_rad_s[:, None] * speed_fraction * tick_s)

    def within_range(self, target_rad: FloatArray) -> FloatArray:
        """Clip joint targets (joints, n) [rad] to the joints' ranges."""
        return np.clip(target_rad, self.low_rad, self.high_rad)

    def towards(self, before_rad: FloatArray, target_rad: FloatArray) -> FloatArray:
        """Move from the last commands towards targets as fast as the motors allow.

        Args:
          before_rad: (joints, n) the last commands [rad].
          target_rad: (joints, n) the targets [rad].

        Returns:
          (joints, n) the new commands [rad].
        """
        change = np.clip(
            self.within_range(target_rad) - before_rad,
            -self.change_rad,
            self.change_rad,
        )
        return before_rad + change
