"""Errors of fitted values where residuals of neighbouring times are correlated."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray

PRIOR_SPREAD = 10.0
"""Standard deviation of the prior on values, in coordinates scaled to be of order one:
values that the data do not determine get intervals about this wide."""

FEWEST = 8
"""Fewest time blocks from which a correlation of the errors in neighbouring ones is
estimated."""

SIGNIFICANT = 2.0
"""A correlation of the errors in neighbouring time blocks counts as real from this
multiple of the standard deviation that chance gives it."""


def information(jacobian: FloatArray) -> FloatArray:
    """(p, p) information on the values in a fit with this (N, p) Jacobian."""
    prior = np.eye(jacobian.shape[1]) / PRIOR_SPREAD**2
    return np.asarray(jacobian.T @ jacobian + prior)


def block_variance(influence: FloatArray, block: IntArray) -> FloatArray:
    """(p,) variances of fitted values if residuals of one time block are correlated.

    The influences are summed within each block and the squares of the sums are added,
    which is right if blocks are independent. If neighbouring blocks are significantly
    correlated, they are joined in pairs until they are not: friction that varies with
    the position, for example, causes an error as long as a stroke lasts.

    `influence` (N, p) is the change of each value by each entry of the residual,
    `block` (N,) the number of each entry's time block, increasing with time.
    """
    sums = np.zeros((int(block.max()) + 1, influence.shape[1]))
    np.add.at(sums, block, influence)
    return np.array([_variance(column) for column in sums.T])


def _variance(sums: FloatArray) -> float:
    """Variance of an estimated value from (blocks,) shifts of it by each time block."""
    variance = float(sums @ sums)
    if len(sums) < FEWEST or variance <= 0:
        return variance
    alike = float(sums[1:] @ sums[:-1]) / variance
    if alike < SIGNIFICANT / np.sqrt(len(sums)):
        return variance
    padded = np.append(sums, 0.0) if len(sums) % 2 else sums
    return _variance(padded.reshape(-1, 2).sum(axis=1))
