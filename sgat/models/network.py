"""Small fully connected networks, evaluated in NumPy: no framework on the fast path."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray, IntArray

Float32Array = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Network:
    """Members of equal shape, each a chain of tanh layers with a linear last one.

    Attributes:
      weights: of each layer (members, inputs, outputs).
      biases: of each layer (members, 1, outputs).
    """

    weights: tuple[Float32Array, ...]
    biases: tuple[Float32Array, ...]

    @property
    def members(self) -> int:
        """How many networks."""
        return len(self.weights[0])

    @property
    def inputs(self) -> int:
        """Width of what goes in."""
        return int(self.weights[0].shape[1])

    @property
    def outputs(self) -> int:
        """Width of what comes out."""
        return int(self.weights[-1].shape[2])

    def member(self, which: int, x: FloatArray) -> Float32Array:
        """(n, outputs) of one member for the (n, inputs) x."""
        values: Any = x.astype(np.float32)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            values = np.tanh(values @ weight[which] + bias[which])
        last: Float32Array = values @ self.weights[-1][which] + self.biases[-1][which]
        return last

    def slope(self, which: int, x: FloatArray, inputs: int) -> Float32Array:
        """(n, outputs, inputs) derivative of one member by the last so many inputs."""
        values: Any = x.astype(np.float32)
        slope: Any = np.eye(self.inputs, dtype=np.float32)[-inputs:]
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            values = np.tanh(values @ weight[which] + bias[which])
            slope = (slope @ weight[which]) * (1 - values**2)[:, None, :]
        last: Float32Array = (slope @ self.weights[-1][which]).swapaxes(1, 2)
        return last

    def mixed(self, x: FloatArray, member: IntArray) -> Float32Array:
        """(n, outputs), each row by the member that the (n,) `member` names."""
        if self.members == 1:
            return self.member(0, x)
        result = np.empty((len(x), self.outputs), np.float32)
        for which in np.unique(member):
            rows = member == which
            result[rows] = self.member(int(which), x[rows])
        return result
