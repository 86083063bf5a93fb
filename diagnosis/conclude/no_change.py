"""Tells effects by which recordings of the healthy robot differ as much.

What a robot's recordings have in common is its model; each one's own temperature,
start or bearing load is a difference of its own. If effects, fitted to the diagnosed
recordings, are no larger than what single recordings differ by, they may be one more
such difference, and no change of the robot. The number of rows does not make that
surer, the number of recordings does.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from diagnosis.effects.library import lasts
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of, number_of_values
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.judging import places_of_effects
from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.distributions import chi2_sf, f_sf, t_sf

LEVEL = 0.05
"""Probability at which the best of all effects at their places would seem a change by
chance; and at which noise alone would make recordings differ as much."""

LEAST_SHARE = 1e-3
"""Share of what the recording that tells most of a value tells of it, from which on
another one tells something."""

FEWEST = 3
"""Fewest recordings of which something is known of how much recordings differ."""


class Told(NamedTuple):
    """What single recordings of one robot, before and after, tell of some effects.

    Attributes:
      values: number of values that are fitted.
      shared: gain [nats] in all diagnosed recordings together, with shared values.
      single: (m,) further gain [nats] in each diagnosed recording with values of its
        own, then (n,) the gain in each of the healthy robot's.
      sizes: (m + n,) the first value that each of them tells by itself, in scaled
        coordinates.
      weights: (m + n,) the inverse of its variance by noise.
      is_healthy: (m + n,) whether it is of the healthy robot.
    """

    values: int
    shared: float
    single: FloatArray
    sizes: FloatArray
    weights: FloatArray
    is_healthy: BoolArray


def may_be_no_change(told: Told, candidates: int) -> bool:
    """Whether recordings of one robot differ by more than noise, and may by so much.

    `candidates` is the number of effects at their places of which the best ones were
    chosen.
    """
    level = LEVEL / max(candidates, 1)
    if told.values == 1:
        tells = told.weights > LEAST_SHARE * told.weights.max(initial=0.0)
        sizes, weights = told.sizes[tells], told.weights[tells]
        before = told.is_healthy[tells]
        if len(before) >= FEWEST and before.any() and not before.all():
            return _same_size(sizes, weights, before, level)
    return _gains_no_more(told, level)


def _same_size(
    sizes: FloatArray, weights: FloatArray, before: BoolArray, level: float
) -> bool:
    """Whether recordings differ by more than noise, and so may their means before.

    The mean sizes of the diagnosed and of the healthy robot's recordings are compared,
    all scattered alike (random effects: DerSimonian and Laird 1986, "Meta-analysis in
    clinical trials", with Student's t).
    """
    sides, free = (before, ~before), len(sizes) - 2
    scatter, known = 0.0, 0.0
    for own in sides:
        total = float(weights[own].sum())
        mean = float(weights[own] @ sizes[own]) / total
        scatter += float(weights[own] @ (sizes[own] - mean) ** 2)
        known += total - float(weights[own] @ weights[own]) / total
    if chi2_sf(scatter, free) > LEVEL:
        return False
    between = max(scatter - free, 0.0) / max(known, 1e-12)
    rough = 1 / (1 / weights + between)
    means = [rough[own] @ sizes[own] / rough[own].sum() for own in sides]
    error = np.sqrt(sum(1 / rough[own].sum() for own in sides))
    return 2 * t_sf(abs(means[1] - means[0]) / error, free) > level


def _gains_no_more(told: Told, level: float) -> bool:
    """Whether single recordings gain more than by noise, and all no more than these.

    Gains by effects with several values are compared by an analysis of variance (Fisher
    1925, "Statistical methods for research workers"); the values of one recording do
    not count as independent.
    """
    count, before = len(told.is_healthy), float(told.is_healthy.sum())
    free, single = count - 2, float(told.single.sum())
    if count < FEWEST or chi2_sf(2 * single, told.values * free) > LEVEL:
        return False
    ratio = told.shared * before / count * free / max(single, 1e-12)
    return f_sf(ratio, told.values, free) > level


def no_change(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel
) -> Model | None:
    """Effects of a fit that may be no change, those that gain least; None if all are.

    Each is asked beside the others, and all are asked together: two that each make up
    for the other tell nothing alone. Effects that share their values are one. `fitted`
    is the fit to the recordings of `both`, `healthy` are predictors of the healthy
    robot. What does not last need not be in all recordings.
    """
    if not healthy:
        return None
    groups = [one for one in groups_of(fitted.model) if lasts(one[0], both.traces)]
    if not groups:
        return None
    # of joints' torques it is known how much each joint differs: that is noise there
    count = 1 if both.knows_healthy_torques else places_of_effects(both)
    told = [_told(both, healthy, fitted, group) for group in groups]
    doubtful = [i for i, one in enumerate(told) if may_be_no_change(one, count)]
    if not doubtful and len(groups) > 1:
        lasting = tuple(one for group in groups for one in group)
        whole = _told(both, healthy, fitted, lasting)
        doubtful = [*range(len(groups))] if may_be_no_change(whole, count) else []
    if not doubtful:
        return None
    return groups[min(doubtful, key=lambda i: told[i].shared)]


def _told(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel, group: Model
) -> Told:
    """What recordings tell of effects beside the others of a fit, to first order."""
    left, change = fitted.residual, fitted.jacobian_of(group)
    at = fitted.coordinates.of(fitted.model)[fitted.coordinates.columns_of(group)][0]
    every = list[tuple[float, float, float, float]]()
    for own in _recordings(both):
        entries = np.isin(both.trace, own)
        part, first = change[entries], change[entries, 0]
        weight = float(first @ first)
        size = at - float(first @ left[entries]) / max(weight, 1e-12)
        every.append((_explained(left[entries], part), size, weight, 0.0))
    for one in healthy:
        for own in _recordings(one):
            some = one.part(own[0], own[-1] + 1)
            (fit,) = fit_all(some, [tuple(group)])
            (bare,) = some.residuals([()])
            gain = 0.5 * float(bare @ bare) - fit.energy
            size = float(fit.coordinates.of(fit.model)[0])
            first = fit.jacobian[:, 0]
            every.append((max(gain, 0.0), size, float(first @ first), 1.0))
    single, sizes, weights, before = np.array(every).T
    shared = max(_without(both, fitted, group) - fitted.energy, 0.0)
    values = number_of_values(tuple(group))
    return Told(values, shared, single, sizes, weights, before > 0)


def _without(both: Predictor, fitted: FittedModel, group: Model) -> float:
    """Energy [nats] without some effects of a fit, the others refitted linearly."""
    less = tuple(one for one in fitted.model if one not in group)
    (left,) = both.residuals([less])
    taken = _explained(left, fitted.jacobian_of(less)) if less else 0.0
    return 0.5 * float(left @ left) - taken


def _explained(left: FloatArray, change: FloatArray) -> float:
    """Gain [nats] of other values in some entries, to first order."""
    found = change @ np.linalg.lstsq(change, left, rcond=None)[0]
    return 0.5 * float(found @ found)


def _recordings(some: Predictor) -> list[list[int]]:
    """Numbers of the parts of each recording."""
    names = [trace.recording for trace in some.traces]
    return [
        [i for i, own in enumerate(names) if own == name]
        for name in dict.fromkeys(names)
    ]
