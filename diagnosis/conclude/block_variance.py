"""Variances of fitted values where errors are alike for longer than a block."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray

FEWEST = 8
"""Blocks, below which nothing can be said about them."""

SIGNIFICANT = 2.0
"""Standard deviations of a correlation that chance makes."""


def block_variance(influence: FloatArray, block: IntArray) -> FloatArray:
    """(p,) variances of values from what each row does to them.

    Sums over blocks are squared, as if blocks did not depend on each other. Where
    neighbours are alike all the same, they are joined, two and two, until they are not:
    friction that differs from place to place is off for as long as a stroke lasts.

    Args:
      influence: (N, p) of each row of the residual on each value.
      block: (N,) numbers from 0, rising with time.
    """
    sums = np.zeros((int(block.max()) + 1, influence.shape[1]))
    np.add.at(sums, block, influence)
    return np.array([_variance(column) for column in sums.T])


def _variance(sums: FloatArray) -> float:
    """Of one value."""
    variance = float(sums @ sums)
    if len(sums) < FEWEST or variance <= 0:
        return variance
    alike = float(sums[1:] @ sums[:-1]) / variance
    if alike < SIGNIFICANT / np.sqrt(len(sums)):
        return variance
    padded = np.append(sums, 0.0) if len(sums) % 2 else sums
    return _variance(padded.reshape(-1, 2).sum(axis=1))
