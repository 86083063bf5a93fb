"""Smooths noisy samples at uneven times, and estimates their rates of change."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline
from scipy.linalg import LinAlgError, solveh_banded

from diagnosis.traces.noise import noise_of
from groundwalk.arrays import FloatArray

_DEGREE = 5
_ORDER = 3
"""The smoothing penalty is the sum of squared differences, of this order, of the spline
coefficients."""
_LEAST_ROWS = 8
_RIDGE = 1e-9
"""Added to the diagonal of the normal equations, so that they can be solved for spline
coefficients in gaps without values, too."""
_STIFFNESS = np.logspace(-4, 10, 22)
"""Weights of the smoothing penalty that are tried, for spline knots one tick apart."""


class Smoothed(NamedTuple):
    """Smoothed channels and their derivatives at the channels' own times.

    The arrays are (T,) for one channel and (T, k) for k channels.
    """

    value: FloatArray
    rate: FloatArray
    acceleration: FloatArray


def smooth(
    time_s: FloatArray, values: FloatArray, noise_std: float | None = None
) -> Smoothed:
    """Smooth one channel as much as its noise requires; all NaN from under 8 values.

    A quintic P-spline with a knot each tick and a third-difference penalty (Eilers
    and Marx 1996). The penalty's weight minimises Mallows' Cp: squared residual plus
    twice the noise's variance for every degree of freedom, which for even samples is
    known in closed form (see `_freedom`). The spline fills in missing values (T,), NaN;
    times (T,) may be uneven. `noise_std` is the standard deviation of the noise of one
    value, None to estimate it.
    """
    valid = np.isfinite(values)
    if valid.sum() < _LEAST_ROWS:
        nothing = np.full(len(values), np.nan)
        return Smoothed(nothing, nothing, nothing)
    if noise_std is None:
        noise_std = noise_of(time_s, values).total
    knots = _knots(time_s)
    centre = float(np.mean(values[valid]))
    coefficients = _fit(time_s[valid], values[valid] - centre, noise_std, knots)
    return _smoothed(BSpline(knots, coefficients, _DEGREE), time_s, centre)


def smooth_below(time_s: FloatArray, values: FloatArray, cutoff_hz: float) -> Smoothed:
    """Smooth one channel such that a sine of `cutoff_hz` keeps half of its size.

    The spline, its gaps and its limits are those of `smooth`; it delays nothing. Its
    penalty's weight follows from the frequency (see `_passed`), not from the noise.
    """
    valid = np.isfinite(values)
    if valid.sum() < _LEAST_ROWS:
        nothing = np.full(len(values), np.nan)
        return Smoothed(nothing, nothing, nothing)
    knots = _knots(time_s)
    turn = np.pi * min(cutoff_hz * float(np.median(np.diff(time_s))), 0.5)
    stiffness = float((2 * np.sin(turn)) ** (-2 * _ORDER))
    centre = float(np.mean(values[valid]))
    normal = _Normal(time_s[valid], values[valid] - centre, knots)
    coefficients = normal.coefficients(stiffness)
    return _smoothed(BSpline(knots, coefficients, _DEGREE), time_s, centre)


def _smoothed(spline: BSpline, time_s: FloatArray, centre: float) -> Smoothed:
    """A spline, plus a constant, and its derivatives at (T,) times."""
    return Smoothed(
        np.asarray(spline(time_s) + centre, float),
        np.asarray(spline(time_s, 1), float),
        np.asarray(spline(time_s, 2), float),
    )


def smooth_columns(time_s: FloatArray, values: FloatArray) -> Smoothed:
    """Smooth each of k channels, the columns of (T, k) values, as `smooth` does."""
    found = [smooth(time_s, column) for column in values.T]
    return Smoothed(*(np.stack(parts, axis=1) for parts in zip(*found, strict=True)))


def _knots(time_s: FloatArray) -> FloatArray:
    """Knots of a quintic spline, one median tick apart, five beyond each end."""
    tick = float(np.median(np.diff(time_s)))
    spans = max(int(np.ceil((time_s[-1] - time_s[0]) / tick)), 1)
    tick = (time_s[-1] - time_s[0]) / spans
    knots = time_s[0] + tick * np.arange(-_DEGREE, spans + _DEGREE + 1)
    knots[-_DEGREE - 1] = time_s[-1]  # rounding must not leave the last row outside
    return np.asarray(knots)


class _Normal:
    """The normal equations of a spline with a smoothing penalty."""

    def __init__(
        self, time_s: FloatArray, values: FloatArray, knots: FloatArray
    ) -> None:
        design = BSpline.design_matrix(time_s, knots, _DEGREE)
        count = design.shape[1]
        self._gram = design.T @ design
        diagonals = [self._gram.diagonal(k) for k in range(_DEGREE + 1)]
        self._bands = _upper_bands(diagonals, count)
        self._bands[-1] += _RIDGE
        self._cost = _penalty_bands(count)
        self.target = np.asarray(design.T @ values, float)
        self._energy = float(values @ values)

    def coefficients(self, stiffness: float) -> FloatArray:
        """Spline coefficients for one weight of the penalty.

        Raises:
          LinAlgError: a gap without values is too long for so stiff a spline.
        """
        bands = self._bands + stiffness * self._cost
        return np.asarray(solveh_banded(bands, self.target, check_finite=False))

    def residual(self, coefficients: FloatArray) -> float:
        """Sum of the squared distances of values and spline."""
        less = 2 * coefficients @ self.target
        return float(self._energy - less + coefficients @ (self._gram @ coefficients))


def _fit(
    time_s: FloatArray, values: FloatArray, noise_std: float, knots: FloatArray
) -> FloatArray:
    """Spline coefficients for the penalty weight with the smallest Mallows' Cp."""
    normal = _Normal(time_s, values, knots)
    best, chosen = np.inf, normal.target
    for stiffness in _STIFFNESS:
        try:
            coefficients = normal.coefficients(stiffness)
        except LinAlgError:
            break
        residual = normal.residual(coefficients)
        criterion = residual + 2 * noise_std**2 * _freedom(stiffness, len(values))
        if criterion < best:
            best, chosen = criterion, coefficients
    return chosen


def _freedom(stiffness: float, rows: int) -> float:
    """Degrees of freedom of a smoothing spline on evenly spaced rows, a knot each.

    The share of a signal that the spline passes, in the mean over all frequencies,
    times the rows counts, plus three for the parabola that the penalty does not see.
    """
    frequency = (np.arange(512) + 0.5) * np.pi / 512
    return float(rows * _passed(frequency, stiffness).mean() + _ORDER)


def _passed(frequency: FloatArray, stiffness: float) -> FloatArray:
    """Share of signals of w radians per row that a spline passes, far from its ends.

    It is 1 / (1 + stiffness w^6), with the difference operator's own response for w.
    """
    response = (2 * np.sin(frequency / 2)) ** (2 * _ORDER)
    return np.asarray(1 / (1 + stiffness * response))


def _penalty_bands(count: int) -> FloatArray:
    """Upper bands of D'D, D being third differences of `count` coefficients."""
    difference = np.diff(np.eye(_ORDER + 1), _ORDER, axis=0)[0]
    diagonals = []
    for k in range(_DEGREE + 1):
        diagonal = np.zeros(count - k)
        for i in range(_ORDER + 1 - k):
            diagonal[i : count - _ORDER + i] += difference[i] * difference[i + k]
        diagonals.append(diagonal)
    return _upper_bands(diagonals, count)


def _upper_bands(diagonals: list[FloatArray], count: int) -> FloatArray:
    """Diagonals as rows of SciPy's `solveh_banded`, the main one in the last row."""
    bands = np.zeros((len(diagonals), count))
    for k, diagonal in enumerate(diagonals):
        bands[-1 - k, k:] = diagonal
    return bands


def moving_mean(values: FloatArray, width: int) -> FloatArray:
    """(T,) means over `width` rows of (T,) values; beyond the ends the end values hold.

    SciPy's `uniform_filter1d` is no substitute: its running sum leaves rounding errors
    behind, so that a joint that rests would seem to turn back and forth.
    """
    before = width // 2
    padded = np.pad(values, (before, width - 1 - before), mode="edge")
    return np.convolve(padded, np.full(width, 1 / width), mode="valid")
