"""Numbers of any unit made comparable: mean 0 and standard deviation 1."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from sgat.models.network import Float32Array

_CONSTANT = 1e-9
"""A spread below this part of the largest value is rounding: the column is constant."""


@dataclass(frozen=True, eq=False)
class Scaling:
    """Mean and scale of each column.

    Dividing a constant column by its tiny spread would blow up whatever is new about
    it later, so its scale is 1; and as nothing is known of how it varies, scaled
    numbers turn back into its constant.

    Attributes:
      mean: (d,) of each column.
      scale: (d,) standard deviation of each column, 1 where it is constant.
      varies: (d,) whether a column is not constant.
    """

    mean: FloatArray
    scale: FloatArray
    varies: BoolArray

    @classmethod
    def of(cls, values: FloatArray) -> Self:
        """The scaling of (N, d) values."""
        spread = values.std(axis=0)
        varies = spread > _CONSTANT * np.abs(values).max(axis=0)
        mean = np.where(varies, values.mean(axis=0), values[0])
        return cls(mean, np.where(varies, spread, 1.0), varies)

    def to_scaled(self, values: FloatArray) -> FloatArray:
        """(n, d) values without their units."""
        return (values - self.mean) / self.scale

    def from_scaled(self, scaled: FloatArray | Float32Array) -> FloatArray:
        """(n, d) scaled numbers as values."""
        return np.asarray(self.mean + self.spread * scaled)

    @property
    def spread(self) -> FloatArray:
        """(d,) value of a scaled 1: the scale, but 0 for a constant column."""
        return self.scale * self.varies
