"""Inverse kinematics, in closed form, of a leg whose joint axes meet.

The equations are for the left leg. For the right one, mirror y of the target and both
roll angles (`MIRROR`).

The yaw angle is given; the other angles follow one after the other. Undo the yaw of the
vector from hip to ankle, p = R_yaw^T (ankle - hip). The knee angle follows from |p|
(law of cosines), the roll is the angle of p in the y-z plane, the pitch is its angle in
the plane of the leg. In the frame of the shin the sole's normal must be
v = R_leg^T normal = (cos r sin a, -sin r, cos r cos a), from which follow the ankle's
roll r = -asin(v_y) and pitch a = atan2(v_x, v_z). rUNSWift's Walk2014 finds the same
pose with three damped least-squares steps.
"""

import math

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import LegGeometry

MIRROR = (1.0, -1.0, 1.0, 1.0, 1.0, -1.0)
"""Factors that turn a left leg's angles (yaw, roll, pitch, knee, ankle pitch and roll)
into those of the right leg in the mirrored pose."""

_MARGIN_M = 1e-6
"""Distance [m] of targets from the ends of a leg's reach, straight and folded, at which
the inverse kinematics are singular."""

_Vector = tuple[FloatArray, FloatArray, FloatArray]


def inverse(
    leg: LegGeometry, yaw_rad: FloatArray, ankle_m: FloatArray, tilt_rad: FloatArray
) -> FloatArray:
    """Joint angles of a left leg with its ankle at a given point and a level sole.

    A target out of reach is moved towards or away from the hip until the leg reaches
    it; the result is always finite.

    Args:
      leg: lengths and axes of the left leg.
      yaw_rad: (...) angle of the yaw joint [rad].
      ankle_m: (3, ...) target of the ankle in the torso's frame [m].
      tilt_rad: (...) forward lean of the torso relative to the level sole [rad].

    Returns:
      (6, ...) yaw, roll, pitch, knee, ankle pitch and ankle roll [rad].
    """
    turn = np.cos(yaw_rad), np.sin(yaw_rad)
    x, y, z = (ankle_m[i] - leg.hip_m[i] for i in range(3))
    x, y, z, length = _within_reach(leg, _yaw_undone(leg, turn, (x, y, z)))
    thigh, tibia = leg.thigh_m, leg.tibia_m
    bend = (length * length - thigh**2 - tibia**2) / (2 * thigh * tibia)
    knee = np.arccos(np.clip(bend, -1.0, 1.0))
    roll = np.arctan2(y, -z)
    pitch = np.arctan2(-x, np.sqrt(y * y + z * z)) - np.arctan2(
        tibia * np.sin(knee), thigh + tibia * np.cos(knee)
    )
    upright = (-np.sin(tilt_rad), np.zeros_like(tilt_rad), np.cos(tilt_rad))
    x, y, z = _yaw_undone(leg, turn, upright)
    cosine, sine = np.cos(roll), np.sin(roll)
    y, z = cosine * y + sine * z, cosine * z - sine * y
    ankle_pitch = np.arctan2(x, z) - (pitch + knee)
    ankle_roll = -np.arcsin(np.clip(y, -1.0, 1.0))
    return np.stack((yaw_rad, roll, pitch, knee, ankle_pitch, ankle_roll))


def _yaw_undone(
    leg: LegGeometry, turn: tuple[FloatArray, FloatArray], vector: _Vector
) -> _Vector:
    """Rotate a vector about the yaw axis by minus the yaw, given as cosine and sine."""
    a, b, c = leg.yaw_axis
    x, y, z = vector
    cosine, sine = turn
    along = (1.0 - cosine) * (a * x + b * y + c * z)
    return (
        cosine * x - sine * (b * z - c * y) + along * a,
        cosine * y - sine * (c * x - a * z) + along * b,
        cosine * z - sine * (a * y - b * x) + along * c,
    )


def _within_reach(
    leg: LegGeometry, target: _Vector
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Nearest target in reach, relative to the hip, and its distance from it [m]."""
    x, y, z = target
    # A target at the hip has no direction: use a point just below instead.
    z = np.where(x * x + y * y + z * z < _MARGIN_M**2, -_MARGIN_M, z)
    length = np.sqrt(x * x + y * y + z * z)
    shortest = math.fabs(leg.thigh_m - leg.tibia_m) + _MARGIN_M
    longest = leg.thigh_m + leg.tibia_m - _MARGIN_M
    reached = np.clip(length, shortest, longest)
    factor = reached / length
    return factor * x, factor * y, factor * z, reached
