"""Inverse model of a stochastic sim: from distributions of next states to actions."""

from pathlib import Path
from typing import NamedTuple, Self

import numpy as np

from groundwalk.arrays import FloatArray
from sgat.models.forward_config import ForwardConfig
from sgat.models.forward_model import ForwardModel
from sgat.transitions import Transitions

_ROUNDS = 3
"""Gauss-Newton steps to the wanted mean; three are enough for smooth networks."""
_FREEDOM = 10.0
"""Standard deviation of a weak prior on the change of an action, in those of the
training actions. Components on which no next state depends stay as the policy's."""
_FINEST = 1e-4
"""Errors of a next state below this share of its standard deviation do not count, which
keeps the matrices of weights invertible."""


class ActionDistribution(NamedTuple):
    """Normal distributions over the actions of n robots.

    Attributes:
      mean: (n, a) in the action's units.
      covariance: (n, a, a) in the action's units squared; may be singular.
    """

    mean: FloatArray
    covariance: FloatArray

    def sample(self, z: FloatArray) -> FloatArray:
        """(n, a) sampled actions, made of standard normal numbers z (n, a)."""
        values, vectors = np.linalg.eigh(self.covariance)
        root = vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]
        return np.asarray(self.mean + (root @ z[..., None])[..., 0])


class DistributionalInverse:
    """Finds actions after which a stochastic sim has a wanted next-state distribution.

    A noisy sim adds its own spread to the effect of an action. If actions were sampled
    from p(a | s, s') for wanted next states s', the sim's noise would come on top and
    the next states would scatter too far. Instead, the moments after the sim's step are
    matched. Let f be the sim's mean next state, S its covariance and B = df/da. A
    wanted mean m and a wanted covariance C are met by

        f(s, a*) = m  and  B cov(a) B^T = C - S.

    f and S are a forward model of the sim. a* is the smallest change of the policy's
    action that meets m, found by Gauss-Newton steps with the weights (C + S)^-1. Where
    the sim is noisier than wanted, C - S has negative parts, which are dropped: no
    action can remove noise. Unlike a least-squares inverse, this does not average over
    actions and so does not make them too small.

    Example:
      >>> inverse = DistributionalInverse().fit(sim_transitions, seed)
      >>> actions = inverse.predict(state, action, *forward.moments(state, action))
    """

    def __init__(self, config: ForwardConfig | None = None) -> None:
        """Choose the sim's forward model; by default it has a full covariance."""
        self.sim = ForwardModel(
            ForwardConfig(head="full") if config is None else config
        )

    def fit(self, transitions: Transitions, seed: np.random.SeedSequence) -> Self:
        """Learn from at least two episodes of the sim; equal seeds give equal bits."""
        self.sim.fit(transitions, seed)
        return self

    def predict(
        self,
        state: FloatArray,
        action: FloatArray,
        mean: FloatArray,
        covariance: FloatArray,
    ) -> ActionDistribution:
        """Distributions of actions that lead to wanted next states.

        Args:
          state: (n, s) states.
          action: (n, a) actions that the policy asks for; the answer is close to them.
          mean: (n, p) wanted mean of the next state.
          covariance: (n, p, p) wanted covariance of the next state.

        Returns:
          Normal distributions over (n, a) actions.
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
        """Mean log-likelihood of the sim's next states, per transition and column."""
        return self.sim.score(transitions)

    def save(self, path: Path) -> None:
        """Write the fitted model to one file."""
        self.sim.save(path)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a file that `save` wrote; BadModelError if it holds no such model."""
        inverse = cls()
        inverse.sim = ForwardModel.load(path)
        return inverse

    def _pull(
        self, state: FloatArray, action: FloatArray, precision: FloatArray
    ) -> FloatArray:
        """(n, a, p) change of the action per error of the next state to correct."""
        effect = self.sim.action_effect(state, action)
        weighted = effect.mT @ precision
        free = np.diag((_FREEDOM * self.sim.action_scale(action.shape[1])) ** -2.0)
        return np.linalg.solve(weighted @ effect + free, weighted).astype(float)


def _positive(symmetric: FloatArray) -> FloatArray:
    """(n, a, a) symmetric matrices without their negative eigenvalues."""
    values, vectors = np.linalg.eigh((symmetric + symmetric.mT) / 2)
    return np.asarray((vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.mT)
