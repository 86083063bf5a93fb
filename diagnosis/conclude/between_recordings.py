"""Tells effects whose size differs from recording to recording by more than noise does.

A robot is not the same in all recordings: clocks, temperatures and loads change a
little. Rows of one recording share such a difference, so that their number makes an
effect no surer. Where recordings disagree, only what all of them together show beyond
their own scatter is evidence.
"""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2, t

from diagnosis.effects.library import lasts
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import FittedModel
from groundwalk.arrays import FloatArray

LEVEL = 0.05
"""Probability at which recordings of one robot would scatter as much by noise alone;
and at which, where they scatter more, an effect is seen of which there is nothing."""

LEAST_WEIGHT = 0.05
"""Share of the largest weight from which on a recording tells the size of an effect."""


def scattered(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel
) -> list[Model]:
    """The effects of a fit that may be nothing but differences between recordings.

    `fitted` is the fit to the recordings of `both`. Recordings of the healthy robot, if
    there are any, show how much recordings of one robot differ. Effects that share
    their values are one. What does not last need not be in all recordings.
    """
    found = []
    for group in groups_of(fitted.model):
        if not lasts(group[0], both.traces):
            continue
        seen = [_sizes(both, fitted, group)]
        seen += [_sizes_before(one, group) for one in healthy]
        if may_be_scatter(seen):
            found.append(group)
    return found


def may_be_scatter(seen: Sequence[tuple[FloatArray, FloatArray]]) -> bool:
    """Whether sizes of an effect, by recording, disagree and are not surely non-zero.

    Each item of `seen` has (k,) sizes and their (k,) weights, the inverse of their
    variances by noise: those of the diagnosed recordings first, then others of the
    healthy robot. The scatter around each item's mean widens the error of the first
    mean (Birge 1932, "The calculation of errors by the method of least squares").
    """
    scatter, free = 0.0, 0
    for sizes, weights in seen:
        tells = weights > LEAST_WEIGHT * max(float(weights.max(initial=0.0)), 1e-12)
        if tells.sum() < 2:
            continue
        own, power = sizes[tells], weights[tells]
        scatter += float(power @ (own - power @ own / power.sum()) ** 2)
        free += int(tells.sum()) - 1
    if not free or chi2.sf(scatter, free) > LEVEL:
        return False
    sizes, weights = seen[0]
    total = float(weights.sum())
    error = np.sqrt(scatter / free / max(total, 1e-12))
    mean = float(weights @ sizes) / max(total, 1e-12)
    return bool(abs(mean) < error * t.isf(LEVEL / 2, free))


def _sizes(
    both: Predictor, fitted: FittedModel, group: Model
) -> tuple[FloatArray, FloatArray]:
    """(k,) sizes of an effect in each recording, 1 on average, and (k,) weights.

    Beside the other effects, whose values may differ as well.
    """
    less = tuple(one for one in fitted.model if one not in group)
    without, along = both.residuals([less, fitted.model])
    change = without - along
    others = fitted.jacobian_of(less)
    if others.shape[1]:
        change = change - others @ np.linalg.lstsq(others, change, rcond=None)[0]
    return _by_recording(both, along + change, change)


def _sizes_before(
    healthy: Predictor, group: Sequence[PlacedEffect]
) -> tuple[FloatArray, FloatArray]:
    """(k,) sizes of an effect in recordings of the healthy robot, and (k,) weights."""
    without, along = healthy.residuals([(), tuple(group)])
    return _by_recording(healthy, without, without - along)


def _by_recording(
    some: Predictor, left: FloatArray, change: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(k,) shares of a change (N,) that explain what is left (N,), and (k,) weights."""
    names = [trace.recording for trace in some.traces]
    number = np.unique(names, return_inverse=True)[1][some.trace]
    weights = np.asarray(np.bincount(number, change**2), float)
    sums = np.bincount(number, change * left)
    return sums / np.maximum(weights, 1e-12), weights
