"""Tells events from what happens in recordings at other times as well.

No model is exact, and its errors come in bursts: a cable pulls, a gear tooth passes. An
effect that acts for a moment explains any of these, wherever it is put. So it is an
event only if it explains more than the largest burst that is left at other times, and
in recordings of the healthy robot, makes likely: their tail is taken as exponential
(peaks over a threshold, Pickands 1975, "Statistical inference using extreme order
statistics").
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.library import lasts
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.bursts import BIN_S, binned
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import FittedModel, fit_all
from groundwalk.arrays import FloatArray

LEVEL = 0.01
"""Probability at which recordings without an event have a burst as large."""

TAIL = 10
"""Number of the largest bursts from which the tail is estimated."""

FEWEST = 4 * TAIL
"""Fewest windows of time whose largest ones are a tail."""

SHOWS_S = 0.1
"""Time [s] for which the error of an event lasts longer than itself: until a servo has
followed again."""


def usual_event(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel
) -> PlacedEffect | None:
    """An effect of a moment that explains no more than usual bursts have, if any.

    `fitted` is the fit to the recordings of `both`; `healthy` predict recordings of the
    healthy robot, if there are any.
    """
    left = [(both, fitted.residual)]
    left += [(one, one.residuals([()])[0]) for one in healthy]
    for group in groups_of(fitted.model):
        if lasts(group[0], both.traces):
            continue
        rest = tuple(one for one in fitted.model if one not in group)
        gain = fit_all(both, [rest])[0].energy - fitted.energy
        lasted_s = group[0].values[-1] + SHOWS_S
        bursts = [burst_nats(*one, lasted_s) for one in left]
        if gain < largest_by_chance(np.concatenate(bursts)):
            return group[0]
    return None


def burst_nats(
    predictor: Predictor, residual: FloatArray, lasted_s: float
) -> FloatArray:
    """(w,) energy above noise [nats] in each channel in windows that do not overlap.

    A window lasts for `lasted_s`, and at least for 50 ms; recordings that are shorter
    have none. `residual` (N,) is in units of noise.
    """
    bins = max(round(lasted_s / BIN_S), 1)
    found = []
    for number in range(len(predictor.traces)):
        for channel in range(len(predictor.channels.names)):
            energy, scored = binned(predictor, residual, number, channel)
            whole = len(energy) // bins * bins
            above = (energy - scored)[:whole].reshape(-1, bins).sum(axis=1)
            found.append(0.5 * above)
    return np.concatenate(found)


def largest_by_chance(nats: FloatArray) -> float:
    """What the largest of as many bursts as (w,) given ones exceeds in 1 of 100 cases.

    In nats, as these. 0 if there are too few to tell.
    """
    if len(nats) < FEWEST:
        return 0.0
    *largest, least = np.sort(nats)[-1 : -TAIL - 2 : -1]
    scale = float(np.mean(np.array(largest) - least))
    return float(least + scale * np.log(TAIL / LEVEL))
