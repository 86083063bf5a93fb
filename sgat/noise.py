"""Standardised noise, tick by tick, for n robots that do not know of each other.

A noise law says what the noise of one robot is like: mean 0 and variance 1 in each
dimension, and whatever memory, tails and correlation it claims. A law is a plain value:
it can be shared and sent to other processes. A stream draws from it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError

CHUNK_TICKS = 64
"""About so many ticks of a robot are drawn at once: one call for all is far cheaper."""

Generators = Sequence[np.random.Generator]


class NoiseLaw(Protocol):
    """What the noise of one robot is like."""

    @property
    def dimensions(self) -> int:
        """How many numbers a tick has."""

    def chunk(self, generators: Generators, last: FloatArray | None) -> FloatArray:
        """(ticks, n, d) of the next ticks.

        What a robot gets depends on its own generator and its own past alone, to the
        bit: not on how many others there are.

        Args:
          generators: n, one per robot.
          last: (n, d) of the tick before, or None at the start.
        """


@dataclass(frozen=True)
class WhiteNoise:
    """Independent normal numbers: what the paper's model assumes.

    Attributes:
      dimensions: how many numbers a tick has.
    """

    dimensions: int

    def __post_init__(self) -> None:
        """Refuse nothing at all."""
        if self.dimensions < 1:
            raise BadValueError(f"dimensions is {self.dimensions}; give at least 1")

    def chunk(self, generators: Generators, last: FloatArray | None) -> FloatArray:
        """See `NoiseLaw`."""
        shape = (CHUNK_TICKS, self.dimensions)
        return np.stack([g.standard_normal(shape) for g in generators], axis=1)


class NoiseStream:
    """The noise of n robots through one episode, each from its own seed."""

    def __init__(self, law: NoiseLaw, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode.

        Args:
          law: what the noise is like.
          seeds: one per robot.
        """
        self._law = law
        self._generators = [np.random.default_rng(seed) for seed in seeds]
        self._member = np.array([g.random() for g in self._generators])
        self._noise = np.empty((0, len(seeds), law.dimensions))
        self._choice = np.empty((0, len(seeds)))
        self._tick = 0

    @property
    def n(self) -> int:
        """How many robots."""
        return len(self._generators)

    def draw(self) -> tuple[FloatArray, FloatArray]:
        """This tick's noise (n, d), and an independent uniform number for each robot.

        The uniform numbers (n,) choose among a mixture's components.
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
        """(n,) uniform numbers that stay for the episode: of an ensemble's member."""
        return self._member
