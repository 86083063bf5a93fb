"""g(s, a): the action that makes the sim do what the real world would."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.models.distributional_inverse import DistributionalInverse
from sgat.models.forward_model import ForwardModel
from sgat.models.inverse_model import InverseModel
from sgat.noise import NoiseLaw, NoiseStream


class Transformer(Protocol):
    """Anything that stands between a policy and n robots of a world."""

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with its own seed."""

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) actions for the world, of states (n, s) and the policy's (n, a)."""


class ActionTransformer:
    """g(s, a) = f_inv(s, f_real(s, a)) for n robots in one call.

    Without noise f_real answers its mean: GAT (Hanna and Stone 2017). With noise it
    answers a sample: SGAT. Both are clipped to the action's bounds, as whatever the
    sim would do with an action beyond them is not what the models learned.
    """

    def __init__(
        self,
        forward: ForwardModel,
        inverse: InverseModel | DistributionalInverse,
        low: FloatArray,
        high: FloatArray,
        noise: NoiseLaw | None = None,
        smoothing: float = 1.0,
        inverse_columns: int | None = None,
    ) -> None:
        """Put the models together.

        Args:
          forward: of the real world.
          inverse: of the sim; a `DistributionalInverse` if the sim is stochastic.
          low: (a,) least action.
          high: (a,) largest action.
          noise: None for GAT; for SGAT the law of the standardised residuals, of as
            many dimensions as a next state has, or as an action has where the
            inverse is distributional.
          smoothing: share of the transformed action; the rest is the policy's.
          inverse_columns: the inverse model sees the first columns of a state; all
            where None.
        """
        if not 0 <= smoothing <= 1:
            raise BadValueError(f"smoothing is {smoothing}; it must be from 0 to 1")
        of_actions = isinstance(inverse, DistributionalInverse)
        wanted = len(low) if of_actions else forward.outcomes
        if noise is not None and noise.dimensions != wanted:
            raise BadValueError(
                f"the noise has {noise.dimensions} dimensions; it must have {wanted}"
            )
        self.forward = forward
        self.inverse = inverse
        self.noise = noise
        self.smoothing = smoothing
        self._columns = slice(inverse_columns)
        self._low, self._high = np.asarray(low, float), np.asarray(high, float)
        self._stream: NoiseStream | None = None

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(a,) least and largest action."""
        return self._low, self._high

    @property
    def inverse_columns(self) -> int | None:
        """How many columns of a state the inverse model sees; None for all."""
        columns: int | None = self._columns.stop
        return columns

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with noise from its own seed."""
        if self.noise is not None:
            self._stream = NoiseStream(self.noise, seeds)

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) transformed actions of states (n, s) and the policy's actions (n, a).

        With noise this is one tick: call it once for each, after `reset`.
        """
        found = self._find(state, action)
        found = action + self.smoothing * (found - action)
        return np.clip(found, self._low, self._high)

    def _find(self, state: FloatArray, action: FloatArray) -> FloatArray:
        if isinstance(self.inverse, DistributionalInverse):
            wanted = self.forward.moments(state, action)
            actions = self.inverse.predict(state, action, *wanted)
            if self.noise is None:
                return actions.mean
            return actions.sample(self._noise_of(len(state)).draw()[0])
        seen = state[:, self._columns]
        if self.noise is None:
            return self.inverse.predict(seen, self.forward.predict(state, action))
        sample = self.forward.sample(state, action, self._noise_of(len(state)))
        return self.inverse.predict(seen, sample)

    def _noise_of(self, n: int) -> NoiseStream:
        if self._stream is None or self._stream.n != n:
            raise BadValueError(f"reset with {n} seeds before {n} robots act")
        return self._stream
