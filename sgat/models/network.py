"""Small fully connected networks, evaluated in NumPy, which is fast for few rows."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray, IntArray

Float32Array = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Network:
    """Networks of equal shape (members), each of tanh layers and a last linear one.

    Attributes:
      weights: for each layer (members, inputs, outputs).
      biases: for each layer (members, 1, outputs).
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
