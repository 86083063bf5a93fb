"""A network together with the scalings of its inputs and outputs."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import torch
from torch import Tensor

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.models.network import Float32Array, Network, Scaling
from sgat.models.network_config import NetworkConfig
from sgat.models.training import Examples, Stage, train
from sgat.transitions import held_out_rows


@dataclass(frozen=True, eq=False)
class ScaledNetwork:
    """A network with scaled inputs and targets.

    Attributes:
      inputs: scaling of the inputs.
      targets: scaling of the values that the network was trained to predict.
      network: takes scaled inputs; its raw outputs describe scaled targets.
    """

    inputs: Scaling
    targets: Scaling
    network: Network

    @classmethod
    def fit(
        cls,
        x: FloatArray,
        y: FloatArray,
        episode: IntArray,
        outputs: int,
        stages: Sequence[Stage],
        config: NetworkConfig,
        seed: np.random.SeedSequence,
        members: int = 1,
    ) -> Self:
        """Train networks to predict y from x.

        If there are several, they differ in their first weights and in their data: each
        learns from its own bootstrap sample of the episodes.

        Args:
          x: (N, inputs) in their own units.
          y: (N, d) targets in their own units.
          episode: (N,) number of the episode of each row.
          outputs: number of raw outputs of a network.
          stages: losses to train with; they define what the raw outputs mean.
          config: shape and training of each network.
          seed: seed of everything random; the same seed gives the same bits.
          members: number of networks.
        """
        rng = np.random.default_rng(seed)
        held_out = held_out_rows(episode, config.validation_share, rng)
        learn = ~held_out
        inputs, targets = Scaling.of(x[learn]), Scaling.of(y[learn])
        x, y = inputs.to_scaled(x), targets.to_scaled(y)
        network = train(
            outputs,
            stages,
            Examples.of(x[learn], y[learn]),
            _sample_weights(episode[learn], members, rng),
            Examples.of(x[held_out], y[held_out]),
            config,
            torch.Generator().manual_seed(int(rng.integers(2**63))),
        )
        return cls(inputs, targets, network)

    def raw(self, x: FloatArray, member: IntArray) -> Float32Array:
        """(n, outputs) raw outputs for x (n, inputs) in their own units.

        `member` (n,) is the number of the network that computes a row.
        """
        if x.ndim != 2 or x.shape[1] != self.network.inputs:
            raise BadValueError(
                f"a model of {self.network.inputs} inputs was given the shape {x.shape}"
            )
        return self.network.mixed(self.inputs.to_scaled(x), member)

    def to_tensors(self) -> dict[str, Tensor]:
        """Weights, biases and scalings as tensors by name, for a file."""
        arrays = {
            f"{name}.{field}": value
            for name in ("inputs", "targets")
            for field, value in vars(getattr(self, name)).items()
        }
        for name in ("weights", "biases"):
            for k, value in enumerate(getattr(self.network, name)):
                arrays[f"{name}.{k}"] = value
        return {name: torch.tensor(value) for name, value in arrays.items()}

    @classmethod
    def from_tensors(cls, tensors: dict[str, Tensor]) -> Self:
        """Undo `to_tensors`; ValueError if the shapes do not fit together."""
        arrays = {name: tensor.numpy() for name, tensor in tensors.items()}
        inputs, targets = (
            Scaling(
                *(arrays[f"{name}.{field}"] for field in ("mean", "scale", "varies"))
            )
            for name in ("inputs", "targets")
        )
        for scaling in (inputs, targets):
            if len({value.shape for value in vars(scaling).values()}) != 1:
                raise ValueError("a scaling's columns differ in number")
        layers = range(sum(name.startswith("weights.") for name in arrays))
        weights = tuple(arrays[f"weights.{k}"] for k in layers)
        biases = tuple(arrays[f"biases.{k}"] for k in layers)
        members, width = weights[0].shape[0], len(inputs.mean)
        for weight, bias in zip(weights, biases, strict=True):
            if weight.shape[:2] != (members, width):
                raise ValueError("a layer does not fit the one before it")
            width = weight.shape[2]
            if bias.shape != (members, 1, width):
                raise ValueError("a bias does not fit its layer")
        return cls(inputs, targets, Network(weights, biases))


def _sample_weights(
    episode: IntArray, members: int, rng: np.random.Generator
) -> FloatArray:
    """(members, N) counts of a row's episode in each network's bootstrap sample."""
    names, index = np.unique(episode, return_inverse=True)
    if members == 1:
        return np.ones((1, len(episode)))
    share = np.full(len(names), 1 / len(names))
    return rng.multinomial(len(names), share, size=members)[:, index].astype(float)
