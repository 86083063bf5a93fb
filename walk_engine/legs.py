"""Inverse kinematics of both legs, from ankle positions to joint angles."""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import Biped
from walk_engine.chain_ik import ChainLegs
from walk_engine.leg_ik import MIRROR, inverse


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
