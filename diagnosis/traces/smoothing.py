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
    spline = BSpline(knots, coefficients, _DEGREE)
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


def _fit(
    time_s: FloatArray, values: FloatArray, noise_std: float, knots: FloatArray
) -> FloatArray:
    """Spline coefficients for the penalty weight with the smallest Mallows' Cp."""
    design = BSpline.design_matrix(time_s, knots, _DEGREE)
    count = design.shape[1]
    gram = design.T @ design
    bands = _upper_bands([gram.diagonal(k) for k in range(_DEGREE + 1)], count)
    bands[-1] += _RIDGE
    cost = _penalty_bands(count)
    target = np.asarray(design.T @ values, float)
    energy = float(values @ values)
    best, chosen = np.inf, target
    for stiffness in _STIFFNESS:
        try:
            coefficients = solveh_banded(
                bands + stiffness * cost, target, check_finite=False
            )
        except LinAlgError:  # a gap too long for so stiff a spline to cross
            break
        residual = energy - 2 * coefficients @ target
        residual += coefficients @ (gram @ coefficients)
        criterion = residual + 2 * noise_std**2 * _freedom(stiffness, len(values))
        if criterion < best:
            best, chosen = criterion, coefficients
    return chosen


def _freedom(stiffness: float, rows: int) -> float:
    """Degrees of freedom of a smoothing spline on evenly spaced rows, a knot each.

    Far from the ends a signal of w radians per row is multiplied by
    1 / (1 + stiffness w^6). Its mean over w, times the rows, counts, plus three for the
    parabola that the penalty does not see.
    """
    frequency = (np.arange(512) + 0.5) * np.pi / 512
    # the difference operator's own response, exact for all frequencies
    passed = 1 / (1 + stiffness * (2 * np.sin(frequency / 2)) ** (2 * _ORDER))
    return float(rows * passed.mean() + _ORDER)


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
