"""Means in bins, with bands of what pieces of the recordings show."""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray, IntArray

FEWEST_ROWS = 4
"""Fewest rows of a piece in a bin whose mean counts."""

FEWEST_PIECES = 2
"""Fewest pieces with a mean in a bin: one alone has no band."""

BAND = (0.1, 0.5, 0.9)
"""Quantiles over pieces: the low end of a band, its middle, and its high end."""


class Binned(NamedTuple):
    """Means in the b bins that have a band, arrays (b,)."""

    at: FloatArray
    middle: FloatArray
    low: FloatArray
    high: FloatArray
    law: FloatArray


def binned(
    over: FloatArray,
    values: FloatArray,
    law: FloatArray,
    piece: IntArray,
    edges: FloatArray,
) -> Binned:
    """Average values (n,) and laws (n,) in the bins between rising edges.

    `over` (n,) is the quantity that is divided into bins, `piece` (n,) the piece of
    each value. Rows outside of the edges are left out.
    """
    bins, pieces = len(edges) - 1, int(piece.max(initial=0)) + 1
    own = np.searchsorted(edges, over, side="right") - 1
    own[over == edges[-1]] = bins - 1
    inside = (own >= 0) & (own < bins)
    cell = own[inside] * pieces + piece[inside]
    count = np.bincount(cell, minlength=bins * pieces).reshape(bins, pieces)

    def totals(each: FloatArray) -> FloatArray:
        total = np.bincount(cell, each[inside], bins * pieces)
        return np.asarray(total.reshape(bins, pieces), float)

    def means(each: FloatArray) -> FloatArray:
        mean = totals(each) / np.maximum(count, 1)
        return np.where(count >= FEWEST_ROWS, mean, np.nan)

    mean = means(values)
    full = np.isfinite(mean).sum(axis=1) >= FEWEST_PIECES
    if not full.any():
        return Binned(*np.empty((len(Binned._fields), 0)))
    low, middle, high = np.nanquantile(mean[full], BAND, axis=1)
    at = totals(over)[full].sum(axis=1) / count[full].sum(axis=1)
    lawful = np.nanmedian(means(law)[full], axis=1)
    return Binned(at, middle, low, high, lawful)


def quantile_edges(values: FloatArray, bins: int) -> FloatArray:
    """Rising edges of up to `bins` bins, each with equally many of the values (n,)."""
    return np.unique(np.quantile(values, np.linspace(0, 1, bins + 1)))


def even_edges(values: FloatArray, bins: int) -> FloatArray:
    """Rising edges of `bins` bins of equal width, from the 1 % to the 99 % quantile."""
    low, high = np.quantile(values, (0.01, 0.99))
    return np.unique(np.linspace(low, high, bins + 1))
