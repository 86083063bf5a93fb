"""Standardised noise, tick by tick, for n robots that are independent of each other.

A noise law describes the noise of one robot: mean 0 and variance 1 in each dimension,
with a memory, tails and correlations of the law's own. A law is a plain value, so it
can be shared and sent to other processes. A stream draws from a law.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError

CHUNK_TICKS = 64
"""Ticks of noise that are drawn in one call: far cheaper than a call for each tick."""

Generators = Sequence[np.random.Generator]


class NoiseLaw(Protocol):
    """Describes the noise of one robot; a law of your own needs these two members.

    Example:
      See `WhiteNoise`.
    """

    @property
    def dimensions(self) -> int:
        """d, the numbers that are drawn for a robot at each tick."""

    def chunk(self, generators: Generators, last: FloatArray | None) -> FloatArray:
        """Noise of the next ticks.

        A robot's noise depends only on its own generator and its own past, to the last
        bit, and not on the number of other robots.

        Args:
          generators: n random generators, one for each robot.
          last: (n, d) noise of the tick before, or None at the start.

        Returns:
          (ticks, n, d) noise without a unit; the law chooses the number of ticks.
        """


@dataclass(frozen=True)
class WhiteNoise:
    """Independent standard normal numbers, as the SGAT paper's model assumes.

    Attributes:
      dimensions: d, the numbers that are drawn for a robot at each tick.

    Example:
      >>> noise, choice = NoiseStream(WhiteNoise(3), seeds).draw()
    """

    dimensions: int

    def __post_init__(self) -> None:
        """Refuse noise without dimensions."""
        if self.dimensions < 1:
            raise BadValueError(f"dimensions is {self.dimensions}; give at least 1")

    def chunk(self, generators: Generators, last: FloatArray | None) -> FloatArray:
        """The next `CHUNK_TICKS` ticks of noise; see `NoiseLaw.chunk`."""
        shape = (CHUNK_TICKS, self.dimensions)
        return np.stack([g.standard_normal(shape) for g in generators], axis=1)


class NoiseStream:
    """Draws the noise of n robots through one episode, each from its own seed.

    Example:
      See `WhiteNoise`.
    """

    def __init__(self, law: NoiseLaw, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode.

        Args:
          law: describes the noise of each robot.
          seeds: n, one for each robot.
        """
        self._law = law
        self._generators = [np.random.default_rng(seed) for seed in seeds]
        self._member = np.array([g.random() for g in self._generators])
        self._noise = np.empty((0, len(seeds), law.dimensions))
        self._choice = np.empty((0, len(seeds)))
        self._tick = 0

    @property
    def n(self) -> int:
        """Number of robots."""
        return len(self._generators)

    def draw(self) -> tuple[FloatArray, FloatArray]:
        """Noise (n, d) of the next tick, and (n,) uniform numbers from 0 to 1.

        The uniform numbers choose among the components of a mixture.
        """
        if self._tick == len(self._noise):
            last = self._noise[-1] if len(self._noise) else None
            self._noise = self._law.chunk(self._generators, last)
            ticks = len(self._noise)
            self._choice = np.stack([g.random(ticks) for g in self._generators], axis=1)
            self._tick = 0
        self._tick += 1
        return self._noise[self._tick - 1], self._choice[self._tick - 1]

    def member(self) -> FloatArray:
        """(n,) uniform numbers, constant for the episode, that choose a network.

        An ensemble lets each robot keep one of its networks for a whole episode.
        """
        return self._member


def child_of(seed: np.random.SeedSequence, use: int) -> np.random.SeedSequence:
    """A seed for one use, always the same for the same parent and number.

    `SeedSequence.spawn` would count up in the parent and answer differently each time.

    Args:
      seed: the parent, which stays as it is.
      use: number of the use, 0 or more.

    Example:
      >>> child_of(np.random.SeedSequence(1), 2).spawn_key
      (2,)
    """
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, use))
