"""The noise floor of a channel: its quantum and its white noise."""

from dataclasses import dataclass

import numpy as np
from scipy.special import binom
from scipy.stats import chi2

from groundwalk.arrays import BoolArray, FloatArray

_ORDERS = (3, 5)
"""Of the differences; the higher one cancels quick motion better."""
_BLOCK = 40
"""Rows in which motion is either there or not."""
_QUIET = 0.25
"""Share of blocks taken as quiet."""
_FINEST = 1e-6
"""A step below this share of the range is no quantum but rounding."""
_ON_GRID = 0.1
"""A value counts as a multiple within this share of a step ..."""
_NEARLY_ALL = 0.95
"""... and a grid must hold this share of the values."""
_CANDIDATES = (0.0, 0.02, 0.1, 0.25, 0.5, 0.75)
"""Quantiles of the gaps between levels that are tried as steps."""
_GAP = 2.5
"""Ticks longer than this many median ones interrupt the differences."""


@dataclass(frozen=True)
class Noise:
    """What a channel shows when nothing happens, in its unit.

    Attributes:
      std: of the white noise besides rounding.
      quantum: step to which values are rounded; None if they are continuous.
    """

    std: float
    quantum: float | None

    @property
    def total(self) -> float:
        """Standard deviation with that of rounding, quantum / sqrt(12)."""
        return float(np.hypot(self.std, (self.quantum or 0.0) / np.sqrt(12)))

    @property
    def step(self) -> float:
        """What a row may differ by from the one before though nothing happens."""
        return max(self.total, self.quantum or 0.0)


def noise_of(time_s: FloatArray, values: FloatArray) -> Noise:
    """The noise of one channel.

    White noise comes from differences of high order, which a parabola does not have;
    of these from the quietest quarter of blocks, so that motion counts as little as
    it can. Blocks in which a rounded value does not change tell nothing and are left
    out. What remains is an upper bound where the channel never rests.

    Args:
      time_s: (T,) increasing, may be uneven.
      values: (T,) NaN where missing.
    """
    quantum = quantum_of(values)
    there = np.isfinite(values)
    power = min(_quiet_power(time_s[there], values[there], order) for order in _ORDERS)
    return Noise(float(np.sqrt(max(power - (quantum or 0.0) ** 2 / 12, 0.0))), quantum)


def quantum_of(values: FloatArray) -> float | None:
    """The step of which nearly all values are multiples, from any origin.

    Of steps that qualify the largest counts: its fractions would, too.

    Args:
      values: (T,) NaN where missing.

    Returns:
      The step, or None: values are continuous, or too few differ to tell.
    """
    there = values[np.isfinite(values)]
    levels = np.unique(there)
    if len(levels) < 3:
        return None
    finest = _FINEST * (levels[-1] - levels[0])
    levels = levels[np.concatenate([[True], np.diff(levels) > finest])]
    # Noise without a grid hits no value twice; a few levels may fit a grid by chance.
    if len(levels) < 3 or (len(levels) < 2 * 3 and len(there) < 3 * len(levels)):
        return None
    gaps = np.diff(levels)
    candidates = np.unique(np.quantile(gaps, _CANDIDATES, method="lower"))
    for first in candidates[::-1]:
        step = _refined(levels, gaps, float(first))
        phase = (there - np.median(there)) / step
        if np.mean(np.abs(phase - np.round(phase)) < _ON_GRID) >= _NEARLY_ALL:
            return step
    return None


def _refined(levels: FloatArray, gaps: FloatArray, step: float) -> float:
    """A better step: the gaps' average, then the slope of levels over their number."""
    counts = np.maximum(np.round(gaps / step), 1.0)
    on_grid = np.abs(gaps / step - counts) < 2 * _ON_GRID
    if not on_grid.any():
        return step
    step = float(np.median(gaps[on_grid] / counts[on_grid]))
    numbers = np.round((levels - levels[0]) / step)
    slope = np.polynomial.polynomial.polyfit(numbers, levels, 1)[1]
    return float(slope) if abs(slope - step) < _ON_GRID * step else step


def _differences(
    time_s: FloatArray, values: FloatArray, order: int
) -> tuple[FloatArray, BoolArray]:
    """Divided differences over order + 1 rows, scaled to the noise's variance.

    Returns:
      (T - order,) each, with weights of unit length; whether no gap is between their
      rows.
    """
    count, points = max(len(values) - order, 0), range(order + 1)
    if count == 0:
        return np.zeros(0), np.zeros(0, bool)
    tick = np.median(np.diff(time_s))
    times = np.stack([time_s[i : count + i] for i in points])
    windows = np.stack([values[i : count + i] for i in points])
    weights = np.stack(
        [
            1
            / np.prod([(times[i] - times[j]) / tick for j in points if j != i], axis=0)
            for i in points
        ]
    )
    weights /= np.linalg.norm(weights, axis=0)
    close = (np.diff(times, axis=0) < _GAP * tick).all(axis=0)
    return np.sum(weights * windows, axis=0), np.asarray(close, bool)


def _quiet_power(time_s: FloatArray, values: FloatArray, order: int) -> float:
    """Mean square of differences in quiet blocks, as all of white noise would have."""
    differences, valid = _differences(time_s, values, order)
    squares = np.where(valid, differences**2, np.nan)
    whole = len(squares) // _BLOCK * _BLOCK
    if whole < 4 * _BLOCK:
        there = squares[np.isfinite(squares)]
        # the median of a squared standard normal variable
        return float(np.median(there) / chi2.ppf(0.5, 1)) if len(there) else 0.0
    blocks = squares[:whole].reshape(-1, _BLOCK)
    full = blocks[np.isfinite(blocks).sum(axis=1) > _BLOCK // 2]
    power = np.nanmean(full, axis=1) if len(full) else np.zeros(0)
    power = power[power > 0]
    if not len(power):
        return 0.0
    freedom = _BLOCK / _correlated(order)
    low = chi2.ppf(_QUIET, freedom) / freedom
    return float(np.quantile(power, _QUIET) / low)


def _correlated(order: int) -> float:
    """By how much differences of white noise tell less than independent values.

    The correlation of those k rows apart is binom(2p, p + k) / binom(2p, p) for the
    order p; a mean square of n correlated values has n / sum(correlation^2) degrees
    of freedom.
    """
    apart = np.arange(-order, order + 1)
    correlation = binom(2 * order, order + apart) / binom(2 * order, order)
    return float(np.sum(correlation**2))
