"""Standardised noise, tick by tick, for n robots that are independent of each other.

SGAT samples next states with it. A noise law is the distribution of one robot's noise:
mean 0 and variance 1 in each dimension; tails and correlations differ between laws. A
law is a plain value, so it can be shared and sent to other processes. A noise stream
draws the numbers of an episode from a law.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError

CHUNK_TICKS = 64
"""Ticks of noise drawn in one call, which is far cheaper than a call for each tick."""

Generators = Sequence[np.random.Generator]


@dataclass(frozen=True)
class WhiteNoise:
    """Independent standard normal numbers, as the SGAT paper's model assumes.

    Attributes:
      dimensions: d, how many numbers are drawn for a robot at each tick.

    Example:
      >>> noise, choice = NoiseStream(WhiteNoise(3), seeds).draw()
    """

    dimensions: int

    def __post_init__(self) -> None:
        """Refuse fewer than one dimension."""
        if self.dimensions < 1:
            raise BadValueError(f"dimensions is {self.dimensions}; give at least 1")

    def chunk(self, generators: Generators) -> FloatArray:
        """(CHUNK_TICKS, n, d) noise of the next ticks."""
        shape = (CHUNK_TICKS, self.dimensions)
        return np.stack([g.standard_normal(shape) for g in generators], axis=1)


def child_of(seed: np.random.SeedSequence, use: int) -> np.random.SeedSequence:
    """A child seed for one use; the same parent and number always give the same child.

    `SeedSequence.spawn` changes its parent, and so gives another child at each call.
    """
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, use))


class BlockNoise:
    """Noise law: blocks of consecutive standardised residuals, all dimensions together.

    This is the moving block bootstrap (Kuensch 1989). Tails and correlations are those
    of the data, except that blocks are independent of each other: a correlation over k
    ticks shrinks by the factor 1 - k / (length of a block).

    Example:
      >>> law = BlockNoise(forward.residuals(real), real.episode, ticks=50)
    """

    def __init__(self, residuals: FloatArray, episode: IntArray, ticks: int) -> None:
        """Find all blocks of residuals (N, d) within episodes, numbered by (N,)."""
        starts = np.arange(max(len(residuals) - ticks + 1, 0))
        if ticks >= 1:
            starts = starts[episode[starts] == episode[starts + ticks - 1]]
        if ticks < 1 or not len(starts):
            raise BadValueError(
                f"no episode holds a block of {ticks} ticks; the longest has "
                f"{np.unique(episode, return_counts=True)[1].max()}"
            )
        self.ticks = ticks
        self._starts = starts
        self._residuals = _standardised(residuals, starts, ticks)

    @property
    def dimensions(self) -> int:
        """d, how many numbers are drawn for a robot at each tick."""
        return int(self._residuals.shape[1])

    def chunk(self, generators: Generators) -> FloatArray:
        """(ticks, n, d) noise of the next ticks, in whole blocks."""
        blocks = -(-CHUNK_TICKS // self.ticks)
        picks = [g.integers(len(self._starts), size=blocks) for g in generators]
        starts = self._starts[np.stack(picks, axis=1)]
        rows = starts[:, None, :] + np.arange(self.ticks)[:, None]
        return np.asarray(self._residuals[rows.reshape(-1, len(generators))])


NoiseLaw = WhiteNoise | BlockNoise
"""Distribution of one robot's noise, which depends only on its own generator."""


class NoiseStream:
    """Draws the noise of n robots through one episode, each from its own seed."""

    def __init__(self, law: NoiseLaw, seeds: Sequence[np.random.SeedSequence]) -> None:
        """Start an episode of n robots, each with its own seed."""
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

        If a model predicts a mixture, the uniform numbers choose a component.
        """
        if self._tick == len(self._noise):
            self._noise = self._law.chunk(self._generators)
            ticks = len(self._noise)
            self._choice = np.stack([g.random(ticks) for g in self._generators], axis=1)
            self._tick = 0
        self._tick += 1
        return self._noise[self._tick - 1], self._choice[self._tick - 1]

    def member(self) -> FloatArray:
        """(n,) uniform numbers from 0 to 1 that are constant during an episode.

        With them, an ensemble assigns each robot one of its networks for the episode.
        """
        return self._member


def _standardised(residuals: FloatArray, starts: IntArray, ticks: int) -> FloatArray:
    """(N, d) residuals with mean 0 and variance 1 when they are drawn in blocks."""
    edges = np.zeros(len(residuals) + 1)
    np.add.at(edges, starts, 1.0)
    np.add.at(edges, starts + ticks, -1.0)
    weight = np.cumsum(edges[:-1])
    mean = np.average(residuals, axis=0, weights=weight)
    spread = np.sqrt(np.average((residuals - mean) ** 2, axis=0, weights=weight))
    return np.asarray((residuals - mean) / np.where(spread > 0, spread, 1.0))


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
