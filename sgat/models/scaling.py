"""Scaling of columns to mean 0 and standard deviation 1."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from sgat.models.network import Float32Array

_CONSTANT = 1e-9
"""A column is constant if its standard deviation is below this share of its largest
value: then the deviation is rounding."""


@dataclass(frozen=True, eq=False)
class Scaling:
    """Mean and scale of each column.

    A constant column has the scale 1: divided by a tiny standard deviation, any later
    change would become huge. Its scaled numbers are turned back into the constant,
    since how it varies is unknown.

    Attributes:
      mean: (d,) mean of each column.
      scale: (d,) standard deviation of each column, 1 where it is constant.
      varies: (d,) whether a column is not constant.
    """

    mean: FloatArray
    scale: FloatArray
    varies: BoolArray

    @classmethod
    def of(cls, values: FloatArray) -> Self:
        """The scaling of the columns of values (N, d)."""
        spread = values.std(axis=0)
        varies = spread > _CONSTANT * np.abs(values).max(axis=0)
        mean = np.where(varies, values.mean(axis=0), values[0])
        return cls(mean, np.where(varies, spread, 1.0), varies)

    def to_scaled(self, values: FloatArray) -> FloatArray:
        """(n, d) scaled numbers from values (n, d) in their units."""
        return (values - self.mean) / self.scale

    def from_scaled(self, scaled: FloatArray | Float32Array) -> FloatArray:
        """(n, d) values in their units from scaled numbers (n, d)."""
        return np.asarray(self.mean + self.spread * scaled)

    @property
    def spread(self) -> FloatArray:
        """(d,) change of a value per scaled unit; 0 for constant columns."""
        return self.scale * self.varies
