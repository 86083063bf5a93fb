"""Flat ground."""

from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from terrain.ground import Ground


@dataclass(frozen=True, kw_only=True)
class Flat(Ground):
    """Level ground of height 0; no seed makes a difference."""

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Zeros; see `Ground.heights`."""
        return np.zeros((y_m.size, x_m.size))
