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

    Joint arrays (n, joints) are in the description's order. Gyroscope and accelerometer
    (n, 3) are in the torso frame; the latter shows +9.81 upward at rest. The forces (n,
    8) are those on the front left, front right, rear left and rear right sensor of the
    left foot, then of the right foot. Times (n,) count from the start of the rollout.

    Example:
      >>> observation = world.step(command_rad)
      >>> observation.foot_force_n[:, :4].sum(axis=1)  # on the left foot
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

    The torso's position and linear velocity (n, 3) are in the world frame, its angular
    velocity (n, 3) in the torso frame; unit quaternions w, x, y, z (n, 4) turn torso to
    world.

    Example:
      >>> world.truth().base_position_m[:, 0]  # how far each robot has walked
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
