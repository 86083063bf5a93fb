"""Set-points of servos whose firmware limits their speed and acceleration."""

from collections.abc import Mapping

import numpy as np

from groundwalk.arrays import FloatArray

LIMITS = "setpoint_speed_rad_s", "setpoint_acceleration_rad_s2"
"""Attributes of `Joints` that are infinite where set-points are the commands."""

FAST = 1e9
"""Speed [rad/s] and acceleration [rad/s^2] that stand for no limit."""

LEAST_S = 1e-12
"""Duration [s] that stands for none, to avoid division by zero."""


class SetPoints:
    """Set-points (rows, j) that follow targets as fast as limits allow.

    Each speeds up, at the acceleration A, to at most the speed V, and slows down such
    that it comes to rest at the target: a trapezoid of speed over time. In a step dt
    its speed w becomes the u with which it can still stop: (w + u) dt / 2 + u^2 / (2 A)
    is what is left of the way. (Biagiotti and Melchiorri 2008, "Trajectory
    planning for automatic machines and robots", section 3.2.)
    """

    def __init__(self, joints: Mapping[str, FloatArray], step_s: float) -> None:
        """Take limits from arrays (rows, j) of `Joints`, by name."""
        speed, acceleration = (np.minimum(joints[name], FAST) for name in LIMITS)
        self.limited = np.any([np.isfinite(joints[name]) for name in LIMITS], axis=0)
        self._gentle = np.isfinite(joints[LIMITS[1]])
        self._speed, self._acceleration, self._step_s = speed, acceleration, step_s
        self._at_rad: FloatArray | None = None
        self._moving_rad_s = np.zeros_like(speed)

    def begin(self, asked_rad: FloatArray | None) -> None:
        """Begin at rest at these targets (rows, j), or at the next ones."""
        self._at_rad = asked_rad
        self._moving_rad_s = np.zeros_like(self._speed)

    def through(
        self, first: FloatArray, ends: tuple[FloatArray, FloatArray]
    ) -> FloatArray:
        """(rows, j) mean set-points of a step; moves them on.

        `first` is the share of the step in which the first one of the targets `ends`
        holds; all are (rows, j).
        """
        if self._at_rad is None:
            self._at_rad = ends[0].copy()
        mean = np.zeros_like(first)
        for share, target in zip((first, 1 - first), ends, strict=True):
            before = self._at_rad
            self._at_rad = before + self._way(target - before, share * self._step_s)
            mean += share * (before + self._at_rad) / 2
        return mean

    def _way(self, error_rad: FloatArray, step_s: FloatArray) -> FloatArray:
        """(rows, j) angles by which set-points move in steps of so many seconds."""
        before, most = self._moving_rad_s, self._acceleration * step_s
        towards, far = np.where(error_rad < 0, -1.0, 1.0), np.abs(error_rad)
        # half of this step's way is left to the speed before, without a limit to none
        own = np.where(self._gentle, towards * before * step_s / 2, 0.0)
        there = far / np.maximum(step_s, LEAST_S)
        stops = np.hypot(most / 2, self._root(2 * (far - own))) - most / 2
        wanted = towards * np.minimum(np.where(self._gentle, stops, there), self._speed)
        moving = np.minimum(np.maximum(wanted, before - most), before + most)
        self._moving_rad_s = np.where(step_s > 0, moving, before)
        mean = np.where(self._gentle, (before + moving) / 2, moving)
        return np.asarray(mean * step_s)

    def _root(self, twice_rad: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(self._acceleration * np.maximum(twice_rad, 0.0)))
