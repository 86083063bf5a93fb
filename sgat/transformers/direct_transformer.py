"""An action transformer in one network, without an inverse model, and its grounding."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
import torch
from torch import Tensor

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.network import Scaling
from sgat.models.scaled_network import ScaledNetwork, read_model, write_model
from sgat.models.training import Examples, Loss, Stage, train
from sgat.models.transition_models import ForwardModel
from sgat.noise import child_of
from sgat.transformers.catalogue import add_grounding, file_kind
from sgat.transformers.grounding_base import (
    OF_DIRECT,
    OF_SIM_MODEL,
    Grounding,
    GroundingData,
)
from sgat.transitions import Transitions, held_out_rows

DIRECT, _KIND = "direct.pt", "direct transformer"
"""Name of the network's file in a transformer's folder, and kind in that file."""


@file_kind
class DirectTransformer:
    """A network that gives the action with which the sim does what the real world did.

    Let f be a forward model of the sim, r the standard deviation of its residuals and
    (s, a, s') a transition of the real world. The network g minimises

        mean over all dimensions and transitions of ((f(s, g(s, a)) - s') / r)^2.

    GAT and SGAT use an inverse model of the sim instead, which is inaccurate if the
    action of a single tick moves the state little: it prefers actions that were common
    in the sim's data, and magnifies errors of the predicted next state. Here the noise
    of s' averages out.

    The transformer is deterministic. Use it with a sim that is as random as the real
    world, or in place of GAT.

    Example:
      >>> g = DirectTransformer(low, high).fit(real, sim_model, sim_walks, seed)
    """

    kind: ClassVar[str] = "direct"

    def __init__(
        self, low: FloatArray, high: FloatArray, config: NetworkConfig | None = None
    ) -> None:
        """Choose the action's bounds (a,), and the network's shape and training."""
        self.config = NetworkConfig() if config is None else config
        self.bounds = np.asarray(low, float), np.asarray(high, float)
        self._fitted: ScaledNetwork | None = None

    def fit(
        self,
        real: Transitions,
        sim: ForwardModel,
        tried: Transitions,
        seed: np.random.SeedSequence,
    ) -> Self:
        """Fit the network; the same seed gives the same bits.

        Args:
          real: transitions of the real world, of at least two episodes.
          sim: forward model of the sim, with next states like those of `real`.
          tried: the sim's transitions that `sim` was fitted to; their states have only
            the first columns of those of `real`.
          seed: seed of the training.
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

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode; seeds are not used, since this transformer has no noise."""

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) actions for the sim, from states (n, s) and asked actions (n, a)."""
        network = self._network
        member = np.zeros(len(state), np.intp)
        raw = network.raw(np.hstack([state, action]), member)
        return np.clip(network.targets.from_scaled(raw), *self.bounds)

    def save(self, folder: Path) -> dict[str, Any]:
        """Write the network into a folder; `load` needs nothing besides it."""
        write_model(folder / DIRECT, _KIND, self.config, self._network)
        return {}

    @classmethod
    def load(
        cls, folder: Path, header: Mapping[str, Any], low: FloatArray, high: FloatArray
    ) -> Self:
        """Read what `save` wrote; the least and largest action are (a,) each."""
        config, network = read_model(folder / DIRECT, _KIND, NetworkConfig)
        transformer = cls(low, high, config)
        transformer._fitted = network
        return transformer

    @property
    def _network(self) -> ScaledNetwork:
        if self._fitted is None:
            raise BadValueError("this direct transformer has not been fitted")
        return self._fitted


def _told(sim: ForwardModel, tried: Transitions, real: Transitions) -> FloatArray:
    """(N, s + p) states (of the sim) and changes in `real`, scaled as in its model."""
    inputs, targets = sim.scalings
    columns = slice(tried.state.shape[1])
    state = real.state[:, columns] - inputs.mean[columns]
    return np.hstack([state / inputs.scale[columns], targets.to_scaled(real.change)])


def _loss(sim: ForwardModel, tried: Transitions, outputs: Scaling) -> Loss:
    """Training loss: squared error of the sim's next state, in standard deviations."""
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


class UnevenSim(Grounding):
    """Grounding by a `DirectTransformer` before a sim with lumps and noisy sensors."""

    name = "sgat-uneven"
    title = "SGAT, uneven sim"
    uneven_sim = True
    means = (
        "SGAT, uneven sim: randomness is modelled where it arises. The sim has lumps",
        "of its own, so high that the gaits of the real walks fall as often as they",
        "did on real ground, and sensors with the real ones' noise; commands alone",
        "cannot make a robot trip on flat ground. The remaining gap, in the joints, is",
        "closed by one network. It is fitted as a whole so that, after its commands, a",
        "model of the sim predicts the joint positions measured in the real world.",
    )

    def transformer(self, data: GroundingData) -> DirectTransformer:
        """The transformer, fitted at the first call for these data.

        It learns only from the columns of next states that an action moves directly.
        """
        return data.once(self.name, lambda: _fit_direct(data))


def _fit_direct(data: GroundingData) -> DirectTransformer:
    if data.uneven is None:
        raise BadValueError("this grounding needs transitions of an uneven sim")
    moved = slice(data.direct_columns)
    real = replace(data.real, next_state=data.real.next_state[:, moved])
    tried = replace(
        data.uneven,
        state=data.uneven.state[:, : data.sim_columns],
        next_state=data.uneven.next_state[:, moved],
    )
    config = ForwardConfig(beta=1.0)
    sim = ForwardModel(config).fit(tried, child_of(data.seed, OF_SIM_MODEL))
    transformer = DirectTransformer(data.low, data.high)
    return transformer.fit(real, sim, tried, child_of(data.seed, OF_DIRECT))


add_grounding(UnevenSim())
