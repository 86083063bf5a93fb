"""Noise as it really was: blocks of consecutive residuals."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.noise import CHUNK_TICKS, Generators


class BlockNoise:
    """Blocks of consecutive standardised residuals, all dimensions together.

    The moving block bootstrap (Kuensch 1989). Memory, tails and correlation across
    dimensions are the data's, but nothing is remembered from one block to the next:
    a correlation at a lag of k ticks shrinks by 1 - k / block.
    """

    def __init__(self, residuals: FloatArray, episode: IntArray, ticks: int) -> None:
        """Find the blocks; none crosses an episode's end.

        Args:
          residuals: (N, d) of a forward model, best on data that it was not fitted to.
          episode: (N,) as in `Transitions`.
          ticks: length of a block.
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
        """How many numbers a tick has."""
        return int(self._residuals.shape[1])

    def chunk(self, generators: Generators, last: FloatArray | None) -> FloatArray:
        """See `NoiseLaw`; always whole blocks."""
        blocks = -(-CHUNK_TICKS // self.ticks)
        picks = [g.integers(len(self._starts), size=blocks) for g in generators]
        starts = self._starts[np.stack(picks, axis=1)]
        rows = starts[:, None, :] + np.arange(self.ticks)[:, None]
        return np.asarray(self._residuals[rows.reshape(-1, len(generators))])


def _standardised(residuals: FloatArray, starts: IntArray, ticks: int) -> FloatArray:
    """(N, d) with mean 0 and variance 1 as the blocks draw them.

    Rows near an episode's end are in fewer blocks than the others.
    """
    edges = np.zeros(len(residuals) + 1)
    np.add.at(edges, starts, 1.0)
    np.add.at(edges, starts + ticks, -1.0)
    weight = np.cumsum(edges[:-1])
    mean = np.average(residuals, axis=0, weights=weight)
    spread = np.sqrt(np.average((residuals - mean) ** 2, axis=0, weights=weight))
    return np.asarray((residuals - mean) / np.where(spread > 0, spread, 1.0))
