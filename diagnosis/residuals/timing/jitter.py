"""Measures how much a clock jitters, in what a model leaves of recordings.

Errors of a model change slowly from row to row, those of the clock do not. If all
joints are read at once the error is common to a row, and shows in the products of their
residuals, however far off the model is; if one after the other, each has its own, which
only a good model lets one see.
"""

import numpy as np

from diagnosis.residuals.channels import Channels
from groundwalk.arrays import BoolArray, FloatArray

QUICK = np.array([1.0, -3.0, 3.0, -1.0])
"""Weights of four rows whose sum has no constant, slope or curvature in it: what is
left of a residual is noise, since errors of a model change less quickly."""

ROUNDS = 4
"""Times that squares are weighted by what was found before."""

LEAST_AT_REST = 0.5
"""Least noise of a joint at rest as a share of its usual noise: less is no sensor's
noise, but the rounding of numbers."""

ORDINARY, MORE = 0.95, 1.5
"""Share of the rows that are ordinary, and multiple of the mean square up to which
their errors may be jitter: 5 % of normal noise hold a third of its square."""

STRETCHES, MOST_PAIRS = 8, 100
"""Number of stretches of time, and most pairs of channels, in each of which the jitter
of rows is measured: at most times and of most pairs it must come out."""

QUIET = 0.3
"""Share of the rows, those in which a channel is slowest, that show its noise."""

NORMAL = 0.4549
"""Median of the square of a standard normal variable."""


def with_clock(
    channels: Channels, residual: FloatArray, speed: FloatArray, scored: BoolArray
) -> Channels:
    """The channels with the jitter of the clock, and noise without it.

    Args:
      channels: their noise includes what jitter adds on average.
      residual: (rows, c) what a model leaves, in units of noise.
      speed: (rows, c) see `speeds`.
      scored: (rows, c) entries that count.
    """
    quick, whole = _quick(residual), _whole(scored)
    squares, moved = QUICK**2, _windows(speed**2)
    power = np.tensordot(squares, moved, 1)
    least = np.maximum(LEAST_AT_REST, channels.rounding / channels.noise) ** 2
    parts = quick**2 / squares.sum(), power / squares.sum()
    noise, both = _parted(*parts, whole, np.minimum(least, 1.0))
    common = min(_common(quick, speed, whole), both)
    jitter = float(np.sqrt(both - common)), float(np.sqrt(common))
    return channels.jittering(np.sqrt(noise), *jitter)


def with_shared_clock(
    channels: Channels, residual: FloatArray, speed: FloatArray, scored: BoolArray
) -> Channels:
    """The channels with the jitter that all in a row share, and noise without it.

    Arguments are those of `with_clock`; the model may be far off.
    """
    quick, whole = _quick(residual), _whole(scored)
    common = _common(quick, speed, whole)
    if not common:
        return channels
    least = np.maximum(LEAST_AT_REST, channels.rounding / channels.noise) ** 2
    moved = np.tensordot(QUICK**2, _windows(speed**2), 1)
    noise = np.ones(len(channels.names))
    for c in range(len(noise)):
        own = np.flatnonzero(whole[:, c])
        slow = own[np.argsort(moved[own, c], kind="stable")[: int(QUIET * len(own))]]
        if len(slow):
            square = np.median(quick[slow, c] ** 2) / NORMAL
            square -= common * np.mean(moved[slow, c])
            noise[c] = square / np.sum(QUICK**2)
    noise = np.clip(noise, np.minimum(least, 1.0), 1.0)
    return channels.jittering(np.sqrt(noise), 0.0, float(np.sqrt(common)))


def _common(quick: FloatArray, speed: FloatArray, whole: BoolArray) -> float:
    """Square of the jitter [s^2] of whole rows; 0 unless most pairs of channels agree.

    Errors that a row's channels share show in products of their residuals. The median
    over pairs and stretches of time is taken, by how much each tells.
    """
    first, second = np.triu_indices(quick.shape[1], 1)
    nearest = np.argsort(second - first, kind="stable")[:MOST_PAIRS]
    first, second = first[nearest], second[nearest]
    shared = sum(
        share * part[:, first] * part[:, second]
        for share, part in zip(QUICK**2, _windows(speed), strict=True)
    )
    shared = np.where(whole[:, first] & whole[:, second], shared, 0.0)
    seen = quick[:, first] * quick[:, second]
    starts = np.unique(np.linspace(0, len(quick), STRETCHES, False).astype(int))
    if not shared.any():
        return 0.0
    told, power = (
        np.add.reduceat(one, starts, axis=0).ravel()
        for one in (seen * shared, shared**2)
    )
    told, power = told[power > 0], power[power > 0]
    found = told / power
    order = np.argsort(found, kind="stable")
    share = np.cumsum(power[order]) / power.sum()
    quarter, half = (
        float(found[order][min(int(np.searchsorted(share, at)), len(order) - 1)])
        for at in (0.25, 0.5)
    )
    return half if quarter > 0 else 0.0


def _parted(
    squares: FloatArray, power: FloatArray, whole: BoolArray, least: FloatArray
) -> tuple[FloatArray, float]:
    """(c,) squares of noise at rest, and the square of the jitter [s^2].

    Mean squares of residuals (rows, c) are those of noise plus the jitter's times the
    (rows, c) mean squares of speeds; least squares with weights by size. Jitter
    explains no more than ordinary rows show: what jumps in few is none. Squares of
    noise are (c,) `least` at least.
    """
    count = squares.shape[1]
    noise, jitter = np.ones(count), 0.0
    usual = float(np.sum(whole * power)) / max(int(whole.sum()), 1)
    some = squares[whole] if whole.any() else np.ones(1)
    ordinary = float(np.minimum(some, np.quantile(some, ORDINARY)).mean())
    most = (max(MORE * ordinary, 1.0) - float(least.mean())) / max(usual, 1e-12)
    for _ in range(ROUNDS):
        weight = whole / (noise + jitter * power) ** 2
        means = [np.sum(weight * one, 0) for one in (squares, power)]
        total = np.maximum(np.sum(weight, 0), 1e-12)
        centred = power - means[1] / total
        slope = float(np.sum(weight * centred * squares))
        jitter = slope / max(float(np.sum(weight * centred**2)), 1e-12)
        # what a joint at rest has at least is no jitter when it moves
        spare = np.sum(weight * (squares - least) * power)
        jitter = min(jitter, spare / max(float(np.sum(weight * power**2)), 1e-12))
        jitter = min(max(jitter, 0.0), most)
        noise = np.clip((means[0] - jitter * means[1]) / total, least, 1.0)
    return noise, jitter


def _quick(residual: FloatArray) -> FloatArray:
    """(rows - 3, c) what in a residual changes from row to row."""
    return np.asarray(np.tensordot(QUICK, _windows(residual), 1))


def _whole(scored: BoolArray) -> BoolArray:
    """(rows - 3, c) whether four successive rows all count."""
    return np.asarray(_windows(scored.astype(float)).min(axis=0) > 0)


def _windows(values: FloatArray) -> FloatArray:
    """(4, rows - 3, c) four successive rows."""
    last = len(values) - len(QUICK) + 1
    return np.stack([values[k : k + last] for k in range(len(QUICK))])
