"""A network together with the scalings of its inputs and outputs, and its file.

Files hold plain tensors and JSON, so that reading one runs no code in it.
"""

import io
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np
import torch
from torch import Tensor

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError, BadValueError
from groundwalk.files import write_bytes
from groundwalk.json_data import from_plain
from sgat.models.config import NetworkConfig
from sgat.models.network import Float32Array, Network, Scaling
from sgat.models.training import Examples, Stage, train
from sgat.transitions import held_out_rows


@dataclass(frozen=True, eq=False)
class ScaledNetwork:
    """A network that takes scaled inputs; its raw outputs describe scaled targets."""

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
        """Train networks to predict y (N, d) from x (N, inputs), in their own units.

        Several `members` differ in their first weights, and in their data: each learns
        from its own bootstrap sample of the episodes, numbered by (N,). `stages` define
        what the raw `outputs` mean. The same seed gives the same bits.
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
        scalings = []
        for name in ("inputs", "targets"):
            parts = [arrays[f"{name}.{key}"] for key in ("mean", "scale", "varies")]
            if len({part.shape for part in parts}) != 1:
                raise ValueError("a scaling's columns differ in number")
            scalings.append(Scaling(*parts))
        inputs, targets = scalings
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


Config = TypeVar("Config", bound=NetworkConfig)

_FORMAT = 1


def write_model(
    path: Path, kind: str, config: NetworkConfig, network: ScaledNetwork
) -> None:
    """Write a fitted network and its settings; `kind` is checked by `read_model`."""
    header = {"format": _FORMAT, "kind": kind, "config": asdict(config)}
    content = io.BytesIO()
    torch.save({"header": json.dumps(header), "tensors": network.to_tensors()}, content)
    write_bytes(path, content.getvalue())


def read_model(
    path: Path, kind: str, config_type: type[Config]
) -> tuple[Config, ScaledNetwork]:
    """Read a file that `write_model` wrote, to the last bit; else BadModelError.

    Only tensors and plain values are read (torch's `weights_only`): no code is run.
    """
    try:
        file = io.BytesIO(path.read_bytes())
    except OSError as error:
        raise BadModelError(f"{path} cannot be read: {error.strerror}") from error
    try:
        content = torch.load(file, map_location="cpu", weights_only=True)
        header = json.loads(content["header"])
        found = header["format"], header["kind"]
        if found == (_FORMAT, kind):
            network = ScaledNetwork.from_tensors(content["tensors"])
            config = from_plain(config_type, header["config"], "config", False)
            shape = network.network.outputs, network.network.members
            if shape != config.shape(len(network.targets.mean)):
                raise ValueError("the network does not fit its settings")
            return config, network
    except Exception as error:  # a file of another program can fail in any way
        raise BadModelError(f"{path} is no model file, or a damaged one") from error
    raise BadModelError(
        f"{path} holds a model of kind {found[1]!r}, format {found[0]}; wanted is "
        f"{kind!r}, format {_FORMAT}"
    )


class NetworkModel(Generic[Config]):
    """Base of models that consist of scaled networks, from `fit` or from a file.

    `kind` is the model's name in files and messages; `config_type` is of its settings.
    """

    kind: ClassVar[str]
    config_type: type[Config]

    def __init__(self, config: Config | None = None) -> None:
        """Choose the networks' shape and training; `fit` or `load` sets the weights."""
        self.config = self.config_type() if config is None else config
        self._fitted: ScaledNetwork | None = None

    def save(self, path: Path) -> None:
        """Write the fitted model to one file."""
        write_model(path, self.kind, self.config, self._network)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a file that `save` wrote, to the last bit; else BadModelError."""
        config, network = read_model(path, cls.kind, cls.config_type)
        model = cls(config)
        model._fitted = network
        return model

    @property
    def _network(self) -> ScaledNetwork:
        if self._fitted is None:
            raise BadValueError(f"this {self.kind} model has not been fitted")
        return self._fitted
