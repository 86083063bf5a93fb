"""From a distribution over next states to one over actions, for stochastic sims."""

from pathlib import Path
from typing import NamedTuple, Self

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.models.forward_config import ForwardConfig
from sgat.models.forward_model import ForwardModel
from sgat.transitions import Transitions

_ROUNDS = 3
_FREEDOM = 10.0
"""How far an action may move for free, in its own standard deviations."""
_FINEST = 1e-4
"""Part of a next state's standard deviation that need not be hit."""


class ActionDistribution(NamedTuple):
    """Normal distributions over the actions of n robots.

    Attributes:
      mean: (n, a).
      covariance: (n, a, a), possibly singular.
    """

    mean: FloatArray
    covariance: FloatArray

    def sample(self, z: FloatArray) -> FloatArray:
        """(n, a) made of standardised noise z (n, a)."""
        values, vectors = np.linalg.eigh(self.covariance)
        root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
        return np.asarray(self.mean + (root @ z[..., None])[..., 0])


class DistributionalInverse:
    """The actions after which a stochastic sim has the wanted next-state distribution.

    A sim that is itself noisy adds its own spread to whatever the action does. So the
    actions must not be those that the sim may have taken to get to the wanted states,
    p(a | s, s') averaged over them: with the sim's noise on top they would scatter too
    far. The moments must fit after the sim's step: with f the sim's mean next state,
    S its covariance and B = df/da, wanted mean m and covariance C are met by

        f(s, a*) = m  and  B cov(a) B^T = C - S.

    f and S are a forward model of the sim. a* is the least change of the policy's
    action that meets m, by Gauss-Newton steps weighted with (C + S)^-1. Where the sim
    is noisier than what is wanted, cov(a) loses its negative part: no action can help.
    As nothing is averaged over actions, none is shrunk as by a least-squares inverse.
    """

    def __init__(self, config: ForwardConfig | None = None) -> None:
        """Only remember what to fit: by default a full covariance."""
        self.sim = ForwardModel(
            ForwardConfig(head="full") if config is None else config
        )

    def fit(self, transitions: Transitions, seed: np.random.SeedSequence) -> Self:
        """Learn the sim's dynamics from at least two of its episodes."""
        self.sim.fit(transitions, seed)
        return self

    def predict(
        self,
        state: FloatArray,
        action: FloatArray,
        mean: FloatArray,
        covariance: FloatArray,
    ) -> ActionDistribution:
        """Actions for the wanted next states.

        Args:
          state: (n, s).
          action: (n, a) what the policy would do; the answer is near it.
          mean: (n, p) of the wanted next state.
          covariance: (n, p, p) of the wanted next state.
        """
        _, own = self.sim.moments(state, action)
        finest = np.diag((_FINEST * self.sim.outcome_scale) ** 2)
        precision = np.linalg.inv(covariance + own + finest).astype(float)
        found = action
        for _ in range(_ROUNDS):
            pull = self._pull(state, found, precision)
            miss = mean - self.sim.predict(state, found)
            found = found + (pull @ miss[..., None])[..., 0]
        return ActionDistribution(found, _positive(pull @ (covariance - own) @ pull.mT))

    def score(self, transitions: Transitions) -> float:
        """Mean log-likelihood of the sim's model, as of `ForwardModel.score`."""
        return self.sim.score(transitions)

    def save(self, path: Path) -> None:
        """Write everything to one file."""
        self.sim.save(path)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read back what `save` has written, to the same bits."""
        inverse = cls()
        inverse.sim = ForwardModel.load(path)
        return inverse

    def _pull(
        self, state: FloatArray, action: FloatArray, precision: FloatArray
    ) -> FloatArray:
        """(n, a, p) how much the action changes per miss of the next state."""
        effect = self.sim.action_effect(state, action)
        weighted = effect.mT @ precision
        free = np.diag((_FREEDOM * self.sim.action_scale(action.shape[1])) ** -2.0)
        return np.linalg.solve(weighted @ effect + free, weighted).astype(float)


def _positive(symmetric: FloatArray) -> FloatArray:
    """(n, a, a) without what is negative in it."""
    values, vectors = np.linalg.eigh((symmetric + symmetric.mT) / 2)
    return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.mT)
