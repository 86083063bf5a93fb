"""Where a leg's joint angles put its ankle and its foot."""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import LegGeometry


def forward(leg: LegGeometry, angles_rad: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ankle and foot of the left leg in the torso frame.

    Args:
      leg: lengths and axes of the left leg.
      angles_rad: (6, ...) yaw, roll, pitch, knee, ankle pitch, ankle roll.

    Returns:
      The ankle, (3, ...), and the rotation matrix that turns vectors of the foot's
      frame into the torso's, (3, 3, ...).
    """
    yaw, roll, pitch, knee, ankle_pitch, ankle_roll = angles_rad
    sideways, across = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    rotation = _product(_rotation(leg.yaw_axis, yaw), _rotation(sideways, roll))
    rotation = _product(rotation, _rotation(across, pitch))
    hip = np.reshape(leg.hip_m, (3,) + (1,) * np.ndim(yaw))
    knee_m = hip - leg.thigh_m * rotation[:, 2]
    rotation = _product(rotation, _rotation(across, knee))
    ankle_m = knee_m - leg.tibia_m * rotation[:, 2]
    rotation = _product(rotation, _rotation(across, ankle_pitch))
    return ankle_m, _product(rotation, _rotation(sideways, ankle_roll))


def _rotation(axis: tuple[float, float, float], angle_rad: FloatArray) -> FloatArray:
    """(3, 3, ...) matrices that turn by the angles about one unit vector."""
    a, b, c = axis
    shape = (3, 3) + (1,) * np.ndim(angle_rad)
    cross = np.reshape([[0, -c, b], [c, 0, -a], [-b, a, 0]], shape)
    along = np.reshape(np.outer(axis, axis), shape)
    across = np.reshape(np.eye(3), shape) - along
    rotation: FloatArray = (
        along + np.cos(angle_rad) * across + np.sin(angle_rad) * cross
    )
    return rotation


def _product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Products of (3, 3, ...) matrices."""
    product: FloatArray = (first[:, :, None] * second[None]).sum(axis=1)
    return product
