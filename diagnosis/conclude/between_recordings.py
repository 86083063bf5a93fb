"""Tells effects whose size differs from recording to recording by more than noise does.

A robot is not the same in all recordings: clocks, temperatures and loads change a
little. Rows of one recording share such a difference, so that their number makes an
effect no surer. Where recordings disagree, only what all of them together show beyond
their own scatter is evidence. If parts of one recording disagree as much, the model
fits some motions worse than others, and each part says how much that is.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from diagnosis.effects.library import lasts
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import kinds_of
from diagnosis.search.fitting import FittedModel
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.distributions import chi2_sf, f_sf, t_ppf

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
    their values are one, and so are those of a kind that most joints have: that one
    joint's friction differs is no sign that it has none. What does not last need not be
    in all recordings.
    """
    found = []
    for group in kinds_of(fitted.model, len(both.plant.joints)):
        if not lasts(group[0], both.traces):
            continue
        seen = [_sizes(both, fitted, group)]
        seen += [_sizes_before(one, group) for one in healthy]
        if may_be_scatter(seen):
            found.append(group)
    return found


class Sizes(NamedTuple):
    """(k,) sizes of an effect in parts of recordings.

    Attributes:
      sizes: in units of the size that fits all best.
      weights: the inverse of their variances by noise.
      recording: number of the recording of each part.
    """

    sizes: FloatArray
    weights: FloatArray
    recording: IntArray


def may_be_scatter(seen: Sequence[Sizes]) -> bool:
    """Whether sizes of an effect disagree between recordings and may be zero.

    The diagnosed recordings come first in `seen`, then others of the healthy robot. The
    scatter around each mean widens the error of the first one (Birge 1932, "The
    calculation of errors by the method of least squares"): that of recordings, and that
    of their parts unless it is surely less (analysis of variance, Fisher 1925).
    """
    between, within = (0.0, 0), (0.0, 0)
    for one in seen:
        means = _of_each_recording(one)
        between = _plus(between, _scatter(means))
        for number in means.recording:
            own = one.recording == number
            within = _plus(within, _scatter(Sizes(*(part[own] for part in one))))
    (scatter, free), (inside, more) = between, within
    if not free or chi2_sf(scatter, free) > LEVEL:
        return False
    if more and f_sf(scatter / free / max(inside / more, 1.0), free, more) > LEVEL:
        scatter, free = _plus(between, within)
    total = float(seen[0].weights.sum())
    error = np.sqrt(scatter / free / max(total, 1e-12))
    mean = float(seen[0].weights @ seen[0].sizes) / max(total, 1e-12)
    return bool(abs(mean) < error * -t_ppf(LEVEL / 2, free))


def _plus(one: tuple[float, int], other: tuple[float, int]) -> tuple[float, int]:
    return one[0] + other[0], one[1] + other[1]


def _of_each_recording(some: Sizes) -> Sizes:
    """The mean size in each recording, with its weight."""
    numbers, own = np.unique(some.recording, return_inverse=True)
    weights = np.asarray(np.bincount(own, some.weights), float)
    sums = np.bincount(own, some.weights * some.sizes)
    return Sizes(sums / np.maximum(weights, 1e-12), weights, numbers)


def _scatter(some: Sizes) -> tuple[float, int]:
    """Scatter of sizes around their mean, in units of noise, and degrees of freedom.

    Where the effect hardly shows its size says nothing.
    """
    least = LEAST_WEIGHT * float(some.weights.max(initial=0.0))
    tells = some.weights > max(least, 1e-12)
    if tells.sum() < 2:
        return 0.0, 0
    own, power = some.sizes[tells], some.weights[tells]
    mean = power @ own / power.sum()
    return float(power @ (own - mean) ** 2), int(tells.sum()) - 1


def _sizes(both: Predictor, fitted: FittedModel, group: Model) -> Sizes:
    """Sizes of an effect in each part of the recordings, 1 on average.

    Beside the other effects, whose values may differ as well.
    """
    less = tuple(one for one in fitted.model if one not in group)
    without, along = both.residuals([less, fitted.model])
    change = without - along
    others = fitted.jacobian_of(less)
    if others.shape[1]:
        change = change - others @ np.linalg.lstsq(others, change, rcond=None)[0]
    return _by_part(both, along + change, change)


def _sizes_before(healthy: Predictor, group: Sequence[PlacedEffect]) -> Sizes:
    """Sizes of an effect in recordings of the healthy robot."""
    without, along = healthy.residuals([(), tuple(group)])
    return _by_part(healthy, without, without - along)


def _by_part(some: Predictor, left: FloatArray, change: FloatArray) -> Sizes:
    """Shares of a change (N,) that explain what is left (N,) in each part."""
    names = [trace.recording for trace in some.traces]
    recording = np.unique(names, return_inverse=True)[1]
    count = len(names)
    weights = np.bincount(some.trace, change**2, count).astype(float)
    sums = np.bincount(some.trace, change * left, count)
    return Sizes(sums / np.maximum(weights, 1e-12), weights, recording)
