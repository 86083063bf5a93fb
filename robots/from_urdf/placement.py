"""Placement of one frame in another one."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Placement:
    """A turn and a shift: p_outer = rotation @ p_inner + position_m.

    Attributes:
      rotation: (3, 3) from the inner frame to the outer one.
      position_m: (3,) the inner frame's origin in the outer one.
    """

    rotation: FloatArray
    position_m: FloatArray

    @classmethod
    def none(cls) -> "Placement":
        """Both frames are the same."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def turn(cls, vector_rad: FloatArray) -> "Placement":
        """A turn about a (3,) vector, by its length."""
        if not vector_rad.any():
            return cls.none()
        return cls(Rotation.from_rotvec(vector_rad).as_matrix(), np.zeros(3))

    def __matmul__(self, inner: "Placement") -> "Placement":
        """Where a frame that is placed in the inner frame is in the outer one."""
        return Placement(self.rotation @ inner.rotation, self.points(inner.position_m))

    def points(self, points_m: FloatArray) -> FloatArray:
        """(..., 3) points of the inner frame, seen from the outer one."""
        return np.asarray(points_m @ self.rotation.T + self.position_m)
