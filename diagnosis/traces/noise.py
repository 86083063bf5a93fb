"""Estimates the noise of a recorded channel: white noise and the step of rounding."""

from dataclasses import dataclass

import numpy as np
from scipy.special import binom

from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.distributions import chi2_ppf

_ORDERS = (3, 5)
"""Orders of the differences that noise is estimated from; the smaller result counts.
The higher order cancels quick motion better."""
_BLOCK = 40
"""Rows of a recording in one block; noise is estimated from the quietest blocks."""
_QUIET = 0.25
"""Quantile of the blocks' mean squares that stands for blocks without motion."""
_FINEST = 1e-6
"""Smallest quantum (step of rounding) that is looked for, as a share of a channel's
range; smaller steps come from floating-point numbers."""
_ON_GRID = 0.1
"""Largest distance of a value from a multiple of the quantum, as a share of it."""
_NEARLY_ALL = 0.95
"""Share of the values that must be multiples of a quantum."""
_CANDIDATES = (0.0, 0.02, 0.1, 0.25, 0.5, 0.75)
"""Quantiles of the gaps between distinct values; each one is tried as the quantum."""
_GAP = 2.5
"""Differences are not taken across ticks longer than this many median ticks."""


@dataclass(frozen=True)
class Noise:
    """Sensor noise of a channel, in the channel's unit.

    `std` is the standard deviation of the white noise, rounding not included, `quantum`
    the step to which values are rounded; None if they are continuous.
    """

    std: float
    quantum: float | None

    @property
    def total(self) -> float:
        """Standard deviation of noise and rounding together."""
        return float(np.hypot(self.std, self.rounding))

    @property
    def rounding(self) -> float:
        """Standard deviation of what rounding alone makes."""
        return float((self.quantum or 0.0) / np.sqrt(12))

    @property
    def step(self) -> float:
        """Difference of two successive values that noise or rounding alone can make."""
        return max(self.total, self.quantum or 0.0)


def noise_of(time_s: FloatArray, values: FloatArray) -> Noise:
    """Estimate the noise of one channel.

    Differences of high order cancel smooth motion and keep white noise. They are taken
    from the quietest quarter of all blocks of rows, so that motion counts as little as
    possible. Blocks in which a rounded value does not change are left out. The result
    is an upper bound where the channel never rests. Times (T,) may be uneven; missing
    values (T,) are NaN.
    """
    quantum = quantum_of(values)
    there = np.isfinite(values)
    power = min(_quiet_power(time_s[there], values[there], order) for order in _ORDERS)
    return Noise(float(np.sqrt(max(power - (quantum or 0.0) ** 2 / 12, 0.0))), quantum)


def quantum_of(values: FloatArray) -> float | None:
    """Find the step to which values (T,) are rounded, such as that of an encoder.

    It is the largest step such that nearly all values differ by multiples of it. None
    if they are continuous, or if too few of them differ to know.
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
    """Refine a rounding step by the levels' median gap, then by a line through them."""
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
    """(T - order,) divided differences, and whether their rows have no gap between.

    The weights have unit length, so the variance on white noise is the noise's.
    """
    count, points = max(len(values) - order, 0), range(order + 1)
    if count == 0:
        return np.zeros(0), np.zeros(0, bool)
    tick = np.median(np.diff(time_s))
    times = np.stack([time_s[i : count + i] for i in points])
    windows = np.stack([values[i : count + i] for i in points])
    apart = [[(times[i] - times[j]) / tick for j in points if j != i] for i in points]
    weights = 1 / np.prod(apart, axis=1)
    weights /= np.linalg.norm(weights, axis=0)
    close = (np.diff(times, axis=0) < _GAP * tick).all(axis=0)
    return np.sum(weights * windows, axis=0), np.asarray(close, bool)


def _quiet_power(time_s: FloatArray, values: FloatArray, order: int) -> float:
    """Variance of white noise, from differences of this order in quiet blocks."""
    differences, valid = _differences(time_s, values, order)
    squares = np.where(valid, differences**2, np.nan)
    whole = len(squares) // _BLOCK * _BLOCK
    if whole < 4 * _BLOCK:
        there = squares[np.isfinite(squares)]
        # the median of a squared standard normal variable
        return float(np.median(there) / chi2_ppf(0.5, 1)) if len(there) else 0.0
    blocks = squares[:whole].reshape(-1, _BLOCK)
    full = blocks[np.isfinite(blocks).sum(axis=1) > _BLOCK // 2]
    power = np.nanmean(full, axis=1) if len(full) else np.zeros(0)
    power = power[power > 0]
    if not len(power):
        return 0.0
    freedom = _BLOCK / _correlated(order)
    low = chi2_ppf(_QUIET, freedom) / freedom
    return float(np.quantile(power, _QUIET) / low)


def _correlated(order: int) -> float:
    """How many differences of white noise count as one independent value.

    Differences of order p whose rows are k apart have the correlation binom(2p, p + k)
    / binom(2p, p), up to the sign; a mean square of n correlated values has
    n / sum(correlation^2) degrees of freedom.
    """
    apart = np.arange(-order, order + 1)
    correlation = binom(2 * order, order + apart) / binom(2 * order, order)
    return float(np.sum(correlation**2))
