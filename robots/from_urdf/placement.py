"""Rigid transforms from one coordinate frame to another."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Placement:
    """Placement of an inner frame in an outer one.

    Points transform as p_outer = rotation @ p_inner + position_m.

    Attributes:
      rotation: (3, 3) rotation from the inner frame to the outer one.
      position_m: (3,) origin of the inner frame in the outer one [m].
    """

    rotation: FloatArray
    position_m: FloatArray

    @classmethod
    def none(cls) -> "Placement":
        """Placement of a frame that coincides with the outer frame."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def turn(cls, vector_rad: FloatArray) -> "Placement":
        """Placement that only turns: rotation vector (3,), axis times angle [rad]."""
        if not vector_rad.any():
            return cls.none()
        return cls(Rotation.from_rotvec(vector_rad).as_matrix(), np.zeros(3))

    def __matmul__(self, inner: "Placement") -> "Placement":
        """Chain placements: `inner` of A in B and this one of B in C give A in C."""
        return Placement(self.rotation @ inner.rotation, self.points(inner.position_m))

    def points(self, points_m: FloatArray) -> FloatArray:
        """Transform points (..., 3) [m] from the inner frame to the outer one."""
        return np.asarray(points_m @ self.rotation.T + self.position_m)
