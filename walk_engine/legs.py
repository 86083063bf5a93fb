"""Inverse kinematics of both legs, in closed form if a leg's joint axes meet.

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
from robots.leg_geometry import Biped, LegGeometry
from walk_engine.chain_ik import ChainLegs

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
      yaw_rad: (...) angle of the yaw joint.
      ankle_m: (3, ...) target of the ankle in the torso's frame.
      tilt_rad: (...) forward lean of the torso relative to the level sole.

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


class Legs:
    """Turns positions of the feet into joint angles of a left and a right leg.

    Legs whose joint axes meet are solved in closed form, others by iteration.
    """

    def __init__(self, biped: Biped) -> None:
        """Prepare the solver for a robot's legs."""
        leg = self._leg = biped.leg
        self._chains: ChainLegs | None = None
        self._signs = [np.ones((2, 1))] * 2  # of ankle pitch and roll, for each leg
        if biped.chains is not None:
            self._chains = ChainLegs(biped.chains, leg.thigh_m + leg.tibia_m)
            self._signs = [chain.signs[4:, None] for chain in biped.chains]

    def angles(
        self,
        ankle_m: FloatArray,
        toe_out_rad: FloatArray,
        tilt_rad: FloatArray,
        ankle_rad: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Joint angles of both legs with level soles, plus extra ankle angles.

        Args:
          ankle_m: (3, 2, n) positions of the left and the right ankle in the torso's
            frame [m], y of the right one with the other sign (mirrored).
          toe_out_rad: (2, n) outward turn of the toes by the hip yaw joints [rad].
          tilt_rad: (2, n) forward lean of the torso [rad].
          ankle_rad: (2, 2, n) angles added to pitch and roll of each ankle [rad],
            positive about +y and +x.

        Returns:
          (6, n) angles [rad] of the left and of the right leg, in the signs of the
          robot's joints: yaw, roll, pitch, knee, ankle pitch, ankle roll.
        """
        if self._chains is None:
            # A positive turn about an axis that points down turns the toes inward.
            outward = np.copysign(1.0, self._leg.yaw_axis[2])
            angles = inverse(self._leg, outward * toe_out_rad, ankle_m, tilt_rad)
            left, right = angles[:, 0], angles[:, 1] * np.reshape(MIRROR, (6, 1))
        else:
            start = inverse(self._leg, toe_out_rad, ankle_m, tilt_rad)
            start[[0, 1, 5], 1] *= -1.0
            places = np.moveaxis(ankle_m, 0, -1).copy()
            places[1, :, 1] *= -1.0
            turn = toe_out_rad * np.array([[1.0], [-1.0]])
            found = self._chains.angles(start, places, _foot_rotation(turn, tilt_rad))
            left, right = found[:, 0], found[:, 1]
        left[4:] += self._signs[0] * ankle_rad[:, 0]
        right[4:] += self._signs[1] * ankle_rad[:, 1]
        return left, right


def _foot_rotation(turn_rad: FloatArray, tilt_rad: FloatArray) -> FloatArray:
    """Rotations (2, n, 3, 3) of level feet in the torso's frame, from turn and lean."""
    cos_t, sin_t = np.cos(turn_rad), np.sin(turn_rad)
    cos_p, sin_p = np.cos(tilt_rad), np.sin(tilt_rad)
    zero = np.zeros_like(cos_t)
    rows = (
        (cos_p * cos_t, -cos_p * sin_t, -sin_p),
        (sin_t, cos_t, zero),
        (sin_p * cos_t, -sin_p * sin_t, cos_p),
    )
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1)).copy()
