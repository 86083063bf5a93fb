"""Terrain: flat ground."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from terrain.ground import Ground


@dataclass(frozen=True, kw_only=True)
class Flat(Ground):
    """Terrain of level ground at height 0, the same for every seed.

    Example:
      >>> Flat(x_range_m=(-1.0, 9.0)).make(seed=0).is_flat
      True
    """

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m], all zero, at x (1, columns), y (rows, 1)."""
        return np.zeros((y_m.size, x_m.size))
