"""Small networks evaluated in NumPy, fast for few rows; scaling of their columns."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray, IntArray

Float32Array = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Network:
    """Networks of equal shape (members), each of tanh layers and a last linear one.

    Each layer has weights (members, inputs, outputs) and biases (members, 1, outputs).
    """

    weights: tuple[Float32Array, ...]
    biases: tuple[Float32Array, ...]

    @property
    def members(self) -> int:
        """Number of networks."""
        return len(self.weights[0])

    @property
    def inputs(self) -> int:
        """Number of input columns."""
        return int(self.weights[0].shape[1])

    @property
    def outputs(self) -> int:
        """Number of output columns."""
        return int(self.weights[-1].shape[2])

    def member(self, which: int, x: FloatArray) -> Float32Array:
        """(n, outputs) raw outputs of network number `which` for x (n, inputs)."""
        values: Any = x.astype(np.float32)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            values = np.tanh(values @ weight[which] + bias[which])
        last: Float32Array = values @ self.weights[-1][which] + self.biases[-1][which]
        return last

    def mixed(self, x: FloatArray, member: IntArray) -> Float32Array:
        """(n, outputs) raw outputs for x (n, inputs) of the networks `member` (n,)."""
        if self.members == 1:
            return self.member(0, x)
        result = np.empty((len(x), self.outputs), np.float32)
        for which in np.unique(member):
            rows = member == which
            result[rows] = self.member(int(which), x[rows])
        return result


_CONSTANT = 1e-9
"""A column is constant if its standard deviation is below this share of its largest
value: then the deviation is rounding."""


@dataclass(frozen=True, eq=False)
class Scaling:
    """Mean and scale of each column.

    A constant column has the scale 1: divided by a tiny standard deviation, any later
    change would become huge. Its scaled numbers are turned back into the constant.

    Attributes:
      mean: (d,) mean.
      scale: (d,) standard deviation, 1 where a column is constant.
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
