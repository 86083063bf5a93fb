"""Inverse kinematics of both legs, from ankle positions to joint angles."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import Biped, LegChain, LegGeometry
from walk_engine.chain_ik import ChainLegs
from walk_engine.leg_ik import MIRROR, inverse


class Legs(ABC):
    """Turns positions of the feet into joint angles of a left and a right leg."""

    def __init__(self, leg: LegGeometry, signs: Sequence[FloatArray]) -> None:
        """Keep the geometry of the legs.

        Args:
          leg: the left leg, or the most similar leg whose axes meet.
          signs: for each leg (2, 1) signs of ankle pitch and ankle roll: -1 if the
            joint counts its angle the other way, else 1.
        """
        self._leg = leg
        self._signs = signs

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
        left, right = self._level(ankle_m, toe_out_rad, tilt_rad)
        left[4:] += self._signs[0] * ankle_rad[:, 0]
        right[4:] += self._signs[1] * ankle_rad[:, 1]
        return left, right

    @abstractmethod
    def _level(
        self, ankle_m: FloatArray, toe_out_rad: FloatArray, tilt_rad: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Joint angles (6, n) [rad] of the left and of the right leg with level soles.

        Arguments are those of `Legs.angles`.
        """


def legs_of(biped: Biped) -> Legs:
    """Make the inverse kinematics of both legs, in closed form if the axes meet."""
    if biped.chains is None:
        return MirroredLegs(biped.leg)
    return TwoChains(biped.leg, biped.chains)


class MirroredLegs(Legs):
    """Legs whose joint axes meet and that are mirror images of each other."""

    def __init__(self, leg: LegGeometry) -> None:
        """Keep the lengths and axes of the left leg."""
        super().__init__(leg, [np.ones((2, 1))] * 2)
        # A positive turn about an axis that points down turns the toes inward.
        self._outward = np.copysign(1.0, leg.yaw_axis[2])

    def _level(
        self, ankle_m: FloatArray, toe_out_rad: FloatArray, tilt_rad: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        angles = inverse(self._leg, self._outward * toe_out_rad, ankle_m, tilt_rad)
        return angles[:, 0], angles[:, 1] * np.reshape(MIRROR, (6, 1))


class TwoChains(Legs):
    """Legs of six joints each, whose axes need not meet; solved by iteration."""

    def __init__(self, leg: LegGeometry, chains: tuple[LegChain, LegChain]) -> None:
        """Prepare the solver.

        Args:
          leg: the most similar leg whose axes meet; its solution starts the steps.
          chains: the left and the right leg.
        """
        super().__init__(leg, [chain.signs[4:, None] for chain in chains])
        self._solver = ChainLegs(chains, leg.thigh_m + leg.tibia_m)

    def _level(
        self, ankle_m: FloatArray, toe_out_rad: FloatArray, tilt_rad: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        start = inverse(self._leg, toe_out_rad, ankle_m, tilt_rad)
        start[[0, 1, 5], 1] *= -1.0
        places = np.moveaxis(ankle_m, 0, -1).copy()
        places[1, :, 1] *= -1.0
        turn = toe_out_rad * np.array([[1.0], [-1.0]])
        found = self._solver.angles(start, places, _foot_rotation(turn, tilt_rad))
        return found[:, 0], found[:, 1]


def _foot_rotation(turn_rad: FloatArray, tilt_rad: FloatArray) -> FloatArray:
    """Rotations (2, n, 3, 3) from the frame of a level foot to the torso's.

    Args:
      turn_rad: (2, n) turn of the foot to the left [rad].
      tilt_rad: (2, n) forward lean of the torso [rad].
    """
    cos_t, sin_t = np.cos(turn_rad), np.sin(turn_rad)
    cos_p, sin_p = np.cos(tilt_rad), np.sin(tilt_rad)
    zero = np.zeros_like(cos_t)
    rows = (
        (cos_p * cos_t, -cos_p * sin_t, -sin_p),
        (sin_t, cos_t, zero),
        (sin_p * cos_t, -sin_p * sin_t, cos_p),
    )
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1)).copy()
