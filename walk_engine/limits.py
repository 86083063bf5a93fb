"""What the joints can follow: their ranges and their motors' speeds."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import Biped


@dataclass(frozen=True, eq=False)
class Limits:
    """Bounds of joint commands; arrays (joints, 1).

    Attributes:
      low_rad: lower ends of the ranges.
      high_rad: upper ends of the ranges.
      change_rad: largest change within a tick.
    """

    low_rad: FloatArray
    high_rad: FloatArray
    change_rad: FloatArray

    @classmethod
    def of(cls, biped: Biped, tick_s: float, speed_fraction: float) -> "Limits":
        """The limits of a robot whose commands use a part of its motors' speed."""
        low, high = biped.joint_range_rad.T[:, :, None].copy()
        return cls(low, high, biped.max_speed_rad_s[:, None] * speed_fraction * tick_s)

    def within_range(self, target_rad: FloatArray) -> FloatArray:
        """Cut (joints, n) targets to the joints' ranges."""
        return np.clip(target_rad, self.low_rad, self.high_rad)

    def towards(self, before_rad: FloatArray, target_rad: FloatArray) -> FloatArray:
        """The command next to the last one on the way to the target, (joints, n)."""
        change = np.clip(
            self.within_range(target_rad) - before_rad,
            -self.change_rad,
            self.change_rad,
        )
        return before_rad + change
