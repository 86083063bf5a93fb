"""Models of transitions between the states of a world, forward and inverse.

The forward model is the distribution over next states, the inverse model gives the
action of the sim that leads from one state to another.
"""

from collections.abc import Callable, Iterator
from typing import Self

import numpy as np
import torch
from torch import Tensor

from groundwalk.arrays import FloatArray, IntArray
from sgat.measures import r_squared
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.heads import Head
from sgat.models.network import Float32Array, Scaling
from sgat.models.scaled_network import NetworkModel, ScaledNetwork
from sgat.models.training import Stage, raw_outputs, squared_error
from sgat.noise import NoiseStream
from sgat.transitions import Transitions

_GOLDEN = (5**0.5 - 1) / 2  # its multiples modulo 1 are evenly spread from 0 to 1


class ForwardModel(NetworkModel[ForwardConfig]):
    """p(s' | s, a), the distribution of the next state, learned from transitions.

    Its networks predict the change of the state, scaled in each column. GAT and SGAT
    fit it to the real world.

    Example:
      >>> model = ForwardModel(ForwardConfig(head="full")).fit(transitions, seed)
      >>> mean = model.predict(state, action)
    """

    kind = "forward"
    config_type = ForwardConfig

    def fit(self, transitions: Transitions, seed: np.random.SeedSequence) -> Self:
        """Learn from at least two episodes; the same seed gives the same bits."""
        head = self.config.make_head(transitions.outcomes)
        self._fitted = ScaledNetwork.fit(
            np.hstack([transitions.state, transitions.action]),
            transitions.change,
            transitions.episode,
            head.width,
            _stages(head),
            self.config,
            seed,
            self.config.members,
        )
        return self

    @property
    def outcomes(self) -> int:
        """Number of columns of a next state."""
        return len(self._network.targets.mean)

    @property
    def scalings(self) -> tuple[Scaling, Scaling]:
        """Scalings of the inputs, states beside actions, and of changes of states."""
        return self._network.inputs, self._network.targets

    def predict(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, p) mean next state for states (n, s) and actions (n, a), as in GAT."""
        means = [self._head.mean(raw, np) for raw in self._each(state, action)]
        return self._next_state(state, np.mean(means, axis=0))

    def sample(
        self, state: FloatArray, action: FloatArray, stream: NoiseStream
    ) -> FloatArray:
        """(n, p) sampled next states for states (n, s), actions (n, a), as in SGAT."""
        z, choice = stream.draw()
        member = (stream.member() * self.config.members).astype(np.intp)
        head, raw = self._head, self._raw(state, action, member)
        return self._next_state(state, head.sample(head.parts(raw, np), z, choice))

    def scaled_change(self) -> Callable[[Tensor], Tensor]:
        """A torch function of scaled states and actions, joined (n, s + a).

        It gives the mean scaled changes (n, p) of the state.
        """
        network = self._network.network
        layers = zip(network.weights, network.biases, strict=True)
        parameters = [torch.tensor(array) for layer in layers for array in layer]

        def change(x: Tensor) -> Tensor:
            means: Tensor = self._head.mean(raw_outputs(parameters, x), torch)
            return means.mean(dim=0)

        return change

    def score(self, transitions: Transitions) -> float:
        """Mean log-likelihood of next states per transition and column.

        Larger is better. It is the logarithm of a density, so it can be positive.
        """
        head = self._head
        y = torch.tensor(self._network.targets.to_scaled(transitions.change))
        densities = [
            head.log_density(head.parts(torch.tensor(raw).double(), torch), y)
            for raw in self._each(transitions.state, transitions.action)
        ]
        mixture = torch.logsumexp(torch.stack(densities), dim=0)
        mixture = mixture - np.log(len(densities))
        units = np.log(self._network.targets.scale).sum()
        return (float(mixture.mean()) - float(units)) / self.outcomes

    def residuals(self, transitions: Transitions) -> FloatArray:
        """(N, p) standardised residuals: the noise for which `sample` gives the data.

        They are white and standard normal if the model is right. An ensemble's networks
        take turns by episode; a mixture's components are drawn by their probability,
        with evenly spread numbers in place of random ones.
        """
        _, index = np.unique(transitions.episode, return_inverse=True)
        member = index % self.config.members
        raw = self._raw(transitions.state, transitions.action, member)
        parts = self._head.parts(raw.astype(float), np)
        y = self._network.targets.to_scaled(transitions.change)
        choice = np.modf(np.arange(transitions.n) * _GOLDEN)[0]
        return self._head.residuals(parts, y, choice)

    @property
    def _head(self) -> Head:
        return self.config.make_head(self.outcomes)

    def _raw(
        self, state: FloatArray, action: FloatArray, member: IntArray
    ) -> Float32Array:
        return self._network.raw(np.hstack([state, action]), member)

    def _each(self, state: FloatArray, action: FloatArray) -> Iterator[Float32Array]:
        for member in range(self.config.members):
            yield self._raw(state, action, np.full(len(state), member))

    def _next_state(
        self, state: FloatArray, scaled_change: Float32Array | FloatArray
    ) -> FloatArray:
        change = self._network.targets.from_scaled(scaled_change)
        return state[:, : self.outcomes] + change


def _stages(head: Head) -> list[Stage]:
    """Three stages of training: mean, likelihood, likelihood at a tenth of the rate.

    From a wrong mean, a likelihood would explain the error by a large spread for good.
    """

    def loss(raw: Tensor, y: Tensor) -> Tensor:
        return head.loss(head.parts(raw, torch), y)

    def score(raw: Tensor, y: Tensor) -> Tensor:
        return -head.log_density(head.parts(raw, torch), y)

    def miss(raw: Tensor, y: Tensor) -> Tensor:
        return squared_error(head.mean(raw, torch), y)

    return [Stage(miss, miss), Stage(loss, score), Stage(loss, score, 0.1)]


class InverseModel(NetworkModel[NetworkConfig]):
    """a = f(s, s'): the action of a deterministic sim, fitted by least squares.

    The network sees the state and its change. If several actions lead to the same next
    state, or the sim is noisy, it predicts their mean, which may be too small an
    action: give it data with varied actions.

    Example:
      >>> inverse = InverseModel().fit(sim_transitions, seed)
      >>> action = inverse.predict(state, wanted_next_state)
    """

    kind = "inverse"
    config_type = NetworkConfig

    def fit(self, transitions: Transitions, seed: np.random.SeedSequence) -> Self:
        """Learn from at least two episodes of the sim; equal seeds give equal bits."""
        self._fitted = ScaledNetwork.fit(
            np.hstack([transitions.state, transitions.change]),
            transitions.action,
            transitions.episode,
            transitions.action.shape[1],
            [Stage(squared_error, squared_error, rate) for rate in (1.0, 0.1)],
            self.config,
            seed,
        )
        return self

    def predict(self, state: FloatArray, next_state: FloatArray) -> FloatArray:
        """(n, a) actions that lead from states (n, s) to next states (n, p)."""
        change = next_state - state[:, : next_state.shape[1]]
        member = np.zeros(len(state), np.intp)
        scaled = self._network.raw(np.hstack([state, change]), member)
        return self._network.targets.from_scaled(scaled)

    def score(self, transitions: Transitions) -> FloatArray:
        """(a,) share of the variance of the actions that is predicted, at most 1."""
        predicted = self.predict(transitions.state, transitions.next_state)
        return r_squared(predicted, transitions.action)
