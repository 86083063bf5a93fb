"""When a residual stands out: where something may have pushed."""

import numpy as np
from scipy.stats import chi2

from diagnosis.residuals.leanings import leanings
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.stretches import stretches
from groundwalk.arrays import BoolArray, FloatArray

BIN_S = 0.05
STANDS_OUT = 8.0
"""Times the median energy of the bins."""

LEAST = 4.0
"""And so many times what noise alone would leave ..."""

CHANCE = 1e-3
"""... and more than noise reaches in any bin of a trace, but for this chance."""

REACTION_S = 0.03
"""A push is seen a little after it began."""

LEAD_S = 1.0
"""What pushes all the time began so long before and ends so long after: a fit must not
find that its beginning matters."""

MOST = 3


def bursts(predictor: Predictor, residual: FloatArray) -> list[tuple[float, float]]:
    """Start and end [s] of the strongest bursts, in the time of the traces.

    Energy is summed over channels in bins of 50 ms; neighbouring bins that stand out
    are one burst. What is off all the time or comes back with every motion is none.

    Args:
      predictor: whose residual it is.
      residual: (N,) in units of noise.
    """
    return _strongest(predictor, residual, np.ones(len(residual), bool))


def bursts_of(
    predictor: Predictor, residual: FloatArray, channel: int
) -> tuple[tuple[float, float], ...]:
    """The same of one channel, in the order of time."""
    return tuple(sorted(_strongest(predictor, residual, predictor.channel == channel)))


def _strongest(
    predictor: Predictor, residual: FloatArray, chosen: BoolArray
) -> list[tuple[float, float]]:
    found: list[tuple[float, float, float]] = []
    for number, trace in enumerate(predictor.traces):
        rows = (predictor.trace == number) & chosen
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


def push_intervals(
    predictor: Predictor, residual: FloatArray
) -> list[tuple[float, float]]:
    """Start and duration [s] of pushes that could be: all the time, or for a while."""
    last_s = max(trace.time_s[-1] for trace in predictor.traces)
    short = [
        (max(start - REACTION_S, 0.0), max(end - start - BIN_S, BIN_S))
        for start, end in bursts(predictor, residual)
    ]
    faint = [
        (max(start - REACTION_S, 0.0), end - start)
        for start, end in ([] if short else leanings(predictor, residual))
    ]
    return [(-LEAD_S, float(last_s) + 2 * LEAD_S), *short, *faint]
