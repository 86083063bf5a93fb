"""The gain that effects reach by chance, which a true effect must exceed.

Of many candidates some always fit the noise. How well the best of them does follows
from the data: the residual of a model is cut into blocks of time, and the sign of each
block is drawn at random. What is a pattern in the residual is destroyed, while its size
and its correlations in time stay. The largest gain of any candidate is found for many
such draws (Westfall and Young 1993, "Resampling-based multiple testing"; residuals of
the larger model as in ter Braak 1992, "Permutation versus bootstrap significance
tests").
"""

import numpy as np

from diagnosis.residuals.predictor import Predictor
from groundwalk.arrays import FloatArray, IntArray

DRAWS = 400
"""Number of draws of signs; the 99 % quantile of these lies within 98 and 99.7 %."""

QUANTILE = 0.99
"""Share of recordings without any missing physics in which no effect may be found."""

SEED = 20_260_101
"""Seed of the draws: the same recordings always give the same answer."""

SHORTEST_ROWS = 4
"""Fewest rows of a block."""

FEWEST_BLOCKS = 12
"""Blocks are not made so long that fewer than this number remain."""

ALIKE = 2.0
"""Sums of neighbouring blocks count as correlated from this multiple of the standard
deviation of their correlation by chance."""


def independent_blocks(predictor: Predictor, residual: FloatArray) -> IntArray:
    """(N,) number of the time block of each entry of an (N,) residual.

    Blocks of one length, within one recording each, which is doubled until the sums of
    neighbouring blocks are no longer correlated. Rows without an entry that counts make
    a block no longer.
    """
    channels = len(predictor.channels.names)
    counted = predictor.scored.reshape(-1, channels).any(axis=1)
    rows = np.maximum(np.cumsum(counted) - 1, 0)
    number = predictor.trace.reshape(-1, channels)[:, 0]
    values = residual.reshape(-1, channels)
    length = SHORTEST_ROWS
    while True:
        own = number * (rows.max() + 1) + rows // length
        block = np.unique(own, return_inverse=True)[1]
        sums = np.zeros((block[-1] + 1, channels))
        np.add.at(sums, block, values)
        count = len(sums)
        alike = float(np.sum(sums[1:] * sums[:-1])) / max(float(np.sum(sums**2)), 1e-12)
        degrees = max(count * channels, 1)
        if count < 2 * FEWEST_BLOCKS or alike < ALIKE / np.sqrt(degrees):
            return np.repeat(block, channels)
        length *= 2


def independent_samples(predictor: Predictor, residual: FloatArray) -> int:
    """Number of independent blocks of an (N,) residual, times that of its channels."""
    blocks = independent_blocks(predictor, residual)[predictor.scored]
    channels = predictor.channel[predictor.scored]
    return len(np.unique(blocks)) * len(np.unique(channels))


def in_standard_errors(more: FloatArray) -> float:
    """How much more one model leaves than another, in standard errors.

    `more` are (blocks,) differences of energies in independent blocks of time. They
    count as signed square roots, so that a few moments do not decide.
    """
    roots = np.sign(more) * np.sqrt(np.abs(more))
    deviation = float(np.std(roots, ddof=1)) if len(roots) > 1 else np.inf
    return float(roots.sum() / max(deviation * np.sqrt(len(roots)), 1e-12))


def by_chance(gains: FloatArray) -> float:
    """The gain [nats] that the best candidate exceeds by chance in 1 of 100 cases.

    `gains` (draws,) are the largest ones in each draw of signs.
    """
    return float(np.quantile(gains, QUANTILE))


def signs(blocks: int) -> FloatArray:
    """(draws, blocks) random signs, always the same."""
    return np.random.default_rng(SEED).choice([-1.0, 1.0], (DRAWS, blocks))
