"""Noise added to actions: a noisy real world, or the noise envelope around a sim."""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from sgat.noise import NoiseStream, WhiteNoise


class ActionNoise:
    """Adds normal noise to actions and clips the sum; used like an action transformer.

    A sim with it is the action noise envelope (Jakobi 1995), a baseline that needs no
    data but a guess of the deviation. A copy of the sim with it stands for the real
    world in the SGAT paper (NoisySim, NoisyReal).

    Example:
      >>> noisy = GroundedEnv(env, ActionNoise(0.1, low, high))
    """

    def __init__(self, deviation: float, low: FloatArray, high: FloatArray) -> None:
        """Choose the standard deviation, and the least and largest action (a,)."""
        if not 0 <= deviation < np.inf:
            raise BadValueError(f"deviation is {deviation}; it must not be negative")
        self.deviation = deviation
        self._low, self._high = np.asarray(low, float), np.asarray(high, float)
        self._stream: NoiseStream | None = None

    def reset(self, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with its own seed."""
        self._stream = NoiseStream(WhiteNoise(len(self._low)), seeds)

    def __call__(self, state: FloatArray, action: FloatArray) -> FloatArray:
        """(n, a) noisy actions of one tick; the states (n, s) are not used."""
        if self._stream is None or self._stream.n != len(action):
            raise BadValueError(f"reset with {len(action)} seeds before they act")
        noise, _ = self._stream.draw()
        return np.clip(action + self.deviation * noise, self._low, self._high)
