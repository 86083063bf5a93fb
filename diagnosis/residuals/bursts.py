"""Finds the times at which something may have pushed the robot.

Two detectors: `bursts` finds short intervals of large error, `faint_pushes` finds small
errors of one sign that last too long to be noise but carry too little energy for the
first detector.
"""

from itertools import chain

import numpy as np
from scipy.stats import chi2

from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.trace import stretches
from groundwalk.arrays import FloatArray

BIN_S = 0.05
"""Length of the bins [s] in which squared residuals are summed to find bursts."""

STANDS_OUT = 8.0
"""A burst of error has at least this multiple of the median energy (sum of squared
residuals) of all bins."""

LEAST = 4.0
"""A burst of error has at least this multiple of the energy (sum of squared residuals)
that noise alone leaves in a bin."""

CHANCE = 1e-3
"""Probability that noise alone makes any bin of a recording look like a burst."""

REACTION_S = 0.03
"""Time [s] from a push until the error that it causes becomes visible."""

LEAD_S = 1.0
"""A push that acts all the time begins this long [s] before the recording and ends this
long after it, so that a fit cannot improve by moving its start or end."""

MOST = 3
"""Largest number of bursts of error that are looked for."""

WINDOWS_S = (0.1, 0.25, 0.5)
"""Lengths [s] of the windows in which a mean error is looked for as the sign of a faint
push: a servo stays displaced while it is pushed."""

FAINT = 6.0
"""Standard deviations by which a window's mean error must differ from zero to be the
sign of a push; noise reaches this in no window."""

MEDIAN_OF_NORMAL = 0.6744897501960817
"""Median of the absolute value of a standard normal variable."""

Span = tuple[float, float]
"""Start [s] of something, and its end or its duration [s]."""


def bursts(
    predictor: Predictor, residual: FloatArray, channel: int | None = None
) -> list[Span]:
    """Start and end [s] of the strongest bursts of error, at most three.

    Squared residuals are summed in bins of 50 ms. Neighbouring bins with much more than
    the median form one burst. An error that is present all the time, or at every
    motion, raises the median and is no burst. `residual` (N,) is in units of noise;
    `channel` is the index of the only channel to look at, None for all together.
    """
    found: list[tuple[float, float, float]] = []
    for number, trace in enumerate(predictor.traces):
        rows = predictor.trace == number
        if channel is not None:
            rows &= predictor.channel == channel
        bins = ((trace.time_s - trace.time_s[0]) / BIN_S).astype(int)
        bins = np.repeat(bins, int(rows.sum()) // trace.ticks)
        energy = np.bincount(bins, residual[rows] ** 2)
        scored = np.bincount(bins, predictor.scored[rows])
        by_chance = chi2.isf(CHANCE / len(scored), np.maximum(scored, 1))
        least = max(STANDS_OUT * np.median(energy), LEAST * scored.mean())
        limit = np.maximum(by_chance, least)
        for first, last in stretches(energy > limit):
            start_s = float(trace.time_s[0] + first * BIN_S)
            end_s = float(trace.time_s[0] + last * BIN_S)
            found.append((float(energy[first:last].sum()), start_s, end_s))
    found.sort(reverse=True)
    return [(start, end) for _, start, end in found[:MOST]]


def push_intervals(predictor: Predictor, residual: FloatArray) -> list[Span]:
    """Start and duration [s] of possible pushes, from an (N,) residual [noise].

    The first one lasts for all of the recording; the others are the bursts of error or,
    if there are none, times of small errors of one sign.
    """
    last_s = max(trace.time_s[-1] for trace in predictor.traces)
    short = [
        (max(start - REACTION_S, 0.0), max(end - start - BIN_S, BIN_S))
        for start, end in bursts(predictor, residual)
    ]
    faint = [
        (max(start - REACTION_S, 0.0), end - start)
        for start, end in ([] if short else faint_pushes(predictor, residual))
    ]
    return [(-LEAD_S, float(last_s) + 2 * LEAD_S), *short, *faint]


def faint_pushes(predictor: Predictor, residual: FloatArray) -> list[Span]:
    """Windows in which a faint push may have acted: start and end [s], surest first.

    There is at most one window of each length (0.1, 0.25, 0.5 s): that with the most
    significant mean error in an (N,) residual [noise]. A mean error that all windows
    have, such as that of an unmodelled payload, is ignored.
    """
    c = len(predictor.channels.names)
    own = [
        (trace.time_s, residual[predictor.trace == number].reshape(-1, c))
        for number, trace in enumerate(predictor.traces)
    ]
    best = chain.from_iterable(
        sorted((_most_biased(*one, window_s) for one in own), reverse=True)[:1]
        for window_s in WINDOWS_S
    )
    return [
        (start, end) for sure, start, end in sorted(best, reverse=True) if sure > FAINT
    ]


def _most_biased(
    time_s: FloatArray, residual: FloatArray, window_s: float
) -> tuple[float, float, float]:
    """Find the window of a recording whose mean error differs most from zero.

    `residual` (T, c) is in units of noise. Returns the difference in standard
    deviations, and the window's start and end [s].
    """
    rows = max(int(np.searchsorted(time_s, time_s[0] + window_s)), 1)
    if rows >= len(time_s):
        return 0.0, 0.0, 0.0
    total = np.vstack([np.zeros(residual.shape[1]), np.cumsum(residual, axis=0)])
    mean = np.abs(total[rows:] - total[:-rows]) / np.sqrt(rows)
    usual = np.maximum(np.median(mean, axis=0) / MEDIAN_OF_NORMAL, 1.0)
    sure = np.max(mean / usual, axis=1)
    first = int(np.argmax(sure))
    return float(sure[first]), float(time_s[first]), float(time_s[first + rows - 1])
