"""Arrays for n robots: measurements (`Observation`) and true motion (`Truth`)."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class _PerRobot:
    """Base of dataclasses whose fields are arrays with one row for each robot."""

    def where(self, mask: BoolArray, other: Self) -> Self:
        """Rows of this object where `mask` (n,) is True, rows of `other` elsewhere."""
        if mask.all():
            return self
        merged = {}
        for field in fields(self):
            mine, theirs = getattr(self, field.name), getattr(other, field.name)
            shape = (-1,) + (1,) * (mine.ndim - 1)
            merged[field.name] = np.where(mask.reshape(shape), mine, theirs)
        return type(self)(**merged)

    def finite(self) -> BoolArray:
        """(n,) whether all values of a robot, in all fields, are finite."""
        rows = [getattr(self, field.name) for field in fields(self)]
        finite = [np.isfinite(row).reshape(len(row), -1).all(axis=1) for row in rows]
        return np.asarray(np.logical_and.reduce(finite))


@dataclass(frozen=True, eq=False)
class Observation(_PerRobot):
    """Measurements of n robots at a tick; `World.reset` and `World.step` return them.

    Attributes:
      time_s: (n,) time since the start of the rollout.
      position_rad, velocity_rad_s: (n, joints) in the description's order.
      gyroscope_rad_s: (n, 3) torso frame.
      accelerometer_m_s2: (n, 3) torso frame; +9.81 upward when at rest.
      foot_force_n: (n, 8) force on the front left, front right, rear left and rear
        right sensor of the left foot, then the same of the right foot.
    """

    time_s: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    gyroscope_rad_s: FloatArray
    accelerometer_m_s2: FloatArray
    foot_force_n: FloatArray


@dataclass(frozen=True, eq=False)
class Truth(_PerRobot):
    """True motion of n robots, which `World.truth` returns and no gait sees.

    Attributes:
      base_position_m: (n, 3) position of the torso frame in the world frame.
      base_orientation: (n, 4) unit quaternion w, x, y, z from torso to world.
      base_linear_velocity_m_s: (n, 3) world frame.
      base_angular_velocity_rad_s: (n, 3) torso frame.
    """

    base_position_m: FloatArray
    base_orientation: FloatArray
    base_linear_velocity_m_s: FloatArray
    base_angular_velocity_rad_s: FloatArray


def up_z(orientation: FloatArray) -> FloatArray:
    """(n,) cosine of the angle between a body's up axis and the vertical.

    `orientation` holds (n, 4) unit quaternions w, x, y, z from body to world.
    """
    _, x, y, _ = orientation.T
    return np.asarray(1.0 - 2.0 * (x * x + y * y))
