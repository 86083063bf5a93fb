"""g(s, a) in one network, without an inverse model."""

from collections.abc import Sequence
from pathlib import Path
from typing import Self

import numpy as np
import torch
from torch import Tensor

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError, BadValueError
from sgat.models.forward_model import ForwardModel
from sgat.models.model_file import read_model, write_model
from sgat.models.network_config import NetworkConfig
from sgat.models.scaled_network import ScaledNetwork
from sgat.models.scaling import Scaling
from sgat.models.training import Examples, Loss, Stage, train
from sgat.transitions import Transitions, held_out_rows

_KIND = "direct transformer"


class DirectTransformer:
    """The action after which the sim does what the real world did.

    With f a forward model of the sim, r the standard deviation of its residuals, and
    (s, a, s') what happened in the real world, g is the network that makes

        mean over all dimensions and transitions of ((f(s, g(s, a)) - s') / r)^2

    small. An `ActionTransformer` goes through f_inv instead, and that hurts where one
    tick of an action moves the state little: f_inv is a regression on next states, so
    what it answers is drawn towards the actions that the sim's own policy takes in s,
    away from those that real's latency asks for; and errors of the predicted next state
    come out many times larger. Here the noise of s' is averaged over, and f errs in
    the same way with the sensors' noise in both worlds as long as both have it.

    It is deterministic: use it with a sim that is as random as real, or for GAT.
    """

    def __init__(
        self, low: FloatArray, high: FloatArray, config: NetworkConfig | None = None
    ) -> None:
        """Only remember what to fit.

        Args:
          low: (a,) least action.
          high: (a,) largest action.
          config: of the network.
        """
        self.config = NetworkConfig() if config is None else config
        self._low, self._high = np.asarray(low, float), np.asarray(high, float)
        self._fitted: ScaledNetwork | None = None

    def fit(
        self,
        real: Transitions,
        sim: ForwardModel,
        tried: Transitions,
        seed: np.random.SeedSequence,
    ) -> Self:
        """Learn from at least two episodes of real; the same seed gives the same bits.

        Args:
          real: what the real world did.
          sim: the sim's dynamics, of next states as wide as real's.
          tried: what it was fitted to; its states are the first columns of real's.
          seed: of the training.
        """
        rng = np.random.default_rng(seed)
        held_out = held_out_rows(real.episode, self.config.validation_share, rng)
        learn = ~held_out
        asked = np.hstack([real.state, real.action])
        inputs, outputs = Scaling.of(asked[learn]), Scaling.of(real.action[learn])
        loss, told = _loss(sim, tried, outputs), _told(sim, tried, real)
        x = inputs.to_scaled(asked)
        network = train(
            real.action.shape[1],
            [Stage(loss, loss, rate) for rate in (1.0, 0.1)],
            Examples.of(x[learn], told[learn]),
            np.ones((1, int(learn.sum()))),
            Examples.of(x[held_out], told[held_out]),
            self.config,
            torch.Generator().manual_seed(int(rng.integers(2**63))),
        )
        self._fitted = ScaledNetwork(inputs, outputs, network)
        return self

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(a,) least and largest action."""
        return self._low, self._high

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode; nothing here is random."""

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) actions for the sim, of states (n, s) and the policy's (n, a)."""
        network = self._network
        member = np.zeros(len(state), np.intp)
        raw = network.raw(np.hstack([state, action]), member)
        return np.clip(network.targets.from_scaled(raw), self._low, self._high)

    def save(self, path: Path) -> None:
        """Write everything but the bounds to one file."""
        write_model(path, _KIND, self.config, self._network)

    @classmethod
    def load(cls, path: Path, low: FloatArray, high: FloatArray) -> Self:
        """Read back what `save` has written, to the same bits.

        Raises:
          BadModelError: the file holds no direct transformer.
        """
        config, network = read_model(path, _KIND, NetworkConfig)
        if network.network.outputs != len(network.targets.mean):
            raise BadModelError(f"{path} is no model file, or a damaged one")
        transformer = cls(low, high, config)
        transformer._fitted = network
        return transformer

    @property
    def _network(self) -> ScaledNetwork:
        if self._fitted is None:
            raise BadValueError("this direct transformer has not been fitted")
        return self._fitted


def _told(sim: ForwardModel, tried: Transitions, real: Transitions) -> FloatArray:
    """(N, columns + p) in the sim model's units: states, and how they changed."""
    inputs, targets = sim.scalings
    columns = slice(tried.state.shape[1])
    state = real.state[:, columns] - inputs.mean[columns]
    return np.hstack([state / inputs.scale[columns], targets.to_scaled(real.change)])


def _loss(sim: ForwardModel, tried: Transitions, outputs: Scaling) -> Loss:
    """How far, in residuals of the sim's model, an action leads from what real did."""
    inputs, targets = sim.scalings
    columns, actions = tried.state.shape[1], tried.action.shape[1]
    off = sim.predict(tried.state, tried.action) - tried.next_state
    weight = _tensor(targets.scale / off.std(axis=0))
    slope = _tensor(outputs.spread / inputs.scale[-actions:])
    shift = _tensor((outputs.mean - inputs.mean[-actions:]) / inputs.scale[-actions:])
    change = sim.scaled_change()

    def loss(raw: Tensor, told: Tensor) -> Tensor:
        state, wanted = told[:, :columns], told[:, columns:]
        found = change(torch.hstack([state, shift + slope * raw[0]]))
        return ((found - wanted) * weight).square().sum(dim=-1)[None]

    return loss


def _tensor(values: FloatArray) -> Tensor:
    return torch.tensor(values, dtype=torch.float32)
