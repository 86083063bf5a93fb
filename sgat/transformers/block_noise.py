"""Noise made of a model's recorded residuals, in blocks of consecutive ticks."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.noise import CHUNK_TICKS, Generators


class BlockNoise:
    """Noise law: blocks of consecutive standardised residuals, all dimensions together.

    This is the moving block bootstrap (Kuensch 1989). Tails and correlations are those
    of the data, except that blocks are independent of each other: a correlation over k
    ticks shrinks by the factor 1 - k / (length of a block).

    Example:
      >>> law = BlockNoise(forward.residuals(real), real.episode, ticks=50)
    """

    def __init__(self, residuals: FloatArray, episode: IntArray, ticks: int) -> None:
        """Find all blocks of residuals (N, d) within episodes, numbered by (N,).

        Raises:
          BadValueError: no episode is as long as a block.
        """
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


def _standardised(residuals: FloatArray, starts: IntArray, ticks: int) -> FloatArray:
    """(N, d) residuals with mean 0 and variance 1 when they are drawn in blocks."""
    edges = np.zeros(len(residuals) + 1)
    np.add.at(edges, starts, 1.0)
    np.add.at(edges, starts + ticks, -1.0)
    weight = np.cumsum(edges[:-1])
    mean = np.average(residuals, axis=0, weights=weight)
    spread = np.sqrt(np.average((residuals - mean) ** 2, axis=0, weights=weight))
    return np.asarray((residuals - mean) / np.where(spread > 0, spread, 1.0))
