"""Finds the times at which something may have happened to the robot.

Three detectors: `bursts` finds short intervals of large error, `faint_pushes` finds
small errors of one sign that last too long to be noise but carry too little energy for
the first detector, `onsets` finds moments from which on the error is large.
"""

from itertools import chain

import numpy as np

from diagnosis.effects.parts import Interval
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.trace import stretches
from groundwalk.arrays import FloatArray
from groundwalk.distributions import chi2_isf

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
    return [span for span, _ in _bursts(predictor, residual, channel)]


def _bursts(
    predictor: Predictor, residual: FloatArray, channel: int | None = None
) -> list[tuple[Span, str]]:
    """The strongest bursts, each with the recording that shows it."""
    found: list[tuple[float, Span, str]] = []
    for number, trace in enumerate(predictor.traces):
        energy, scored = binned(predictor, residual, number, channel)
        by_chance = chi2_isf(CHANCE / len(scored), np.maximum(scored, 1))
        least = max(STANDS_OUT * np.median(energy), LEAST * scored.mean())
        limit = np.maximum(by_chance, least)
        for first, last in stretches(energy > limit):
            start_s = float(trace.time_s[0] + first * BIN_S)
            end_s = float(trace.time_s[0] + last * BIN_S)
            sum_ = float(energy[first:last].sum())
            found.append((sum_, (start_s, end_s), trace.recording))
    found.sort(reverse=True)
    return [(span, recording) for _, span, recording in found[:MOST]]


def binned(
    predictor: Predictor,
    residual: FloatArray,
    number: int,
    channel: int | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Sum of squares of a trace's residual in each bin, and its number of entries."""
    trace, rows = predictor.traces[number], predictor.trace == number
    if channel is not None:
        rows &= predictor.channel == channel
    time_s = trace.time_s[trace.compared]
    bins = ((time_s - trace.time_s[0]) / BIN_S).astype(int)
    bins = np.repeat(bins, int(rows.sum()) // trace.rows)
    scored = np.bincount(bins, predictor.scored[rows])
    energy = np.asarray(np.bincount(bins, residual[rows] ** 2), float)
    return energy, scored.astype(float)


def push_intervals(predictor: Predictor, residual: FloatArray) -> list[Interval]:
    """When something may have happened, from an (N,) residual [noise].

    The first interval lasts for all of the recording; the others are the bursts of
    error or, if there are none, times of small errors of one sign; and times from which
    on errors are large. Of several recordings each event may be in one or in all.
    """
    last_s = max(float(trace.time_s[-1]) for trace in predictor.traces)
    short = [
        (max(start - REACTION_S, 0.0), max(end - start - BIN_S, BIN_S), recording)
        for (start, end), recording in _bursts(predictor, residual)
    ]
    faint = [
        (max(start - REACTION_S, 0.0), end - start, None)
        for start, end in ([] if short else faint_pushes(predictor, residual))
    ]
    lasting = [
        (max(start - REACTION_S, 0.0), last_s + LEAD_S - start, recording)
        for start, recording in onsets(predictor, residual)
    ]
    every = [Interval(*one) for one in (*short, *faint, *lasting)]
    several = len({trace.recording for trace in predictor.traces}) > 1
    own = [one for one in every if one.recording and several]
    shared = [one._replace(recording=None) for one in every]
    return [Interval(-LEAD_S, last_s + 2 * LEAD_S), *shared, *own]


def onsets(predictor: Predictor, residual: FloatArray) -> list[tuple[float, str]]:
    """Times from which on the error is large, each with its recording, surest first.

    Of each recording's bins, the parts one after the other, a first stretch has little
    energy and the rest much. The likeliest moment is that which explains the energies
    best by two variances of a normal distribution. `residual` (N,) is in units of
    noise.
    """
    found = []
    for recording in dict.fromkeys(trace.recording for trace in predictor.traces):
        own = [
            number
            for number, trace in enumerate(predictor.traces)
            if trace.recording == recording
        ]
        own.sort(key=lambda number: float(predictor.traces[number].time_s[0]))
        parts = [binned(predictor, residual, number) for number in own]
        energy, scored = (np.concatenate(one) for one in zip(*parts, strict=True))
        start_s = np.concatenate(
            [
                predictor.traces[number].time_s[0] + BIN_S * np.arange(len(part[0]))
                for number, part in zip(own, parts, strict=True)
            ]
        )
        counted = scored > 0
        gain, first = _change(energy[counted], scored[counted])
        if first:
            found.append((gain, float(start_s[counted][first]), recording))
            # between two parts it may have been at any time
            earliest_s = float(start_s[counted][first - 1]) + BIN_S
            if earliest_s < found[-1][1] - BIN_S:
                found.append((gain, earliest_s, recording))
    found.sort(reverse=True)
    return [(start, recording) for _, start, recording in found[:MOST]]


def _change(energy: FloatArray, scored: FloatArray) -> tuple[float, int]:
    """Gain [nats] of two variances over one, and the first bin of the second; 0: none.

    The second variance must stand out from the first one and from noise.
    """
    if len(energy) < 4:
        return 0.0, 0
    sums, counts = np.cumsum(energy), np.cumsum(scored)
    before = sums[:-1] / counts[:-1]
    count = counts[-1] - counts[:-1]
    after = (sums[-1] - sums[:-1]) / count
    stands_out = after > np.maximum(STANDS_OUT * np.maximum(before, 1.0), LEAST)
    kept = np.maximum(before, 1.0)
    gain = 0.5 * (
        counts[-1] * np.log(max(sums[-1] / counts[-1], 1.0))
        - counts[:-1] * np.log(kept)
        - count * np.log(np.maximum(after, 1.0))
    )
    gain = np.where(stands_out, gain, 0.0)
    best = int(np.argmax(gain))
    if gain[best] <= 0:
        return 0.0, 0
    usual = float(np.median(energy[: best + 1] / scored[: best + 1]))
    first = best + 1  # errors may have begun to grow before
    least = max(STANDS_OUT * usual, LEAST)
    while first > 1 and energy[first - 1] > scored[first - 1] * least:
        first -= 1
    return float(gain[best]), first


def faint_pushes(predictor: Predictor, residual: FloatArray) -> list[Span]:
    """Windows in which a faint push may have acted: start and end [s], surest first.

    There is at most one window of each length (0.1, 0.25, 0.5 s): that with the most
    significant mean error in an (N,) residual [noise]. A mean error that all windows
    have, such as that of an unmodelled payload, is ignored.
    """
    c = len(predictor.channels.names)
    own = [
        (
            trace.time_s[trace.compared],
            residual[predictor.trace == number].reshape(-1, c),
        )
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
