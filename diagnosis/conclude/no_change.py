"""Tells effects by which recordings of the healthy robot differ as much.

What a robot's recordings have in common is its model; each one's own temperature,
start or bearing load is a difference of its own. If effects, fitted to the diagnosed
recordings, take away no more than fitted to single recordings on top of what these have
in common, they may be one more such difference, and no change of the robot (analysis of
variance, Fisher 1925, "Statistical methods for research workers"). The number of rows
does not make that surer, the number of recordings does.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import chi2, f

from diagnosis.effects.library import lasts
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import groups_of, number_of_values
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.judging import places_of_effects
from groundwalk.arrays import FloatArray

LEVEL = 0.05
"""Probability at which the best of all effects at their places would seem a change by
chance; and at which noise alone would make recordings differ as much."""


class Gains(NamedTuple):
    """What some effects gain [nats] in recordings of one robot, before and after.

    Attributes:
      values: number of values that are fitted.
      shared: gain in all diagnosed recordings together, with values of their own.
      single: further gain in all recordings, each with values of its own, those of the
        healthy robot beside none.
      diagnosed: number of diagnosed recordings.
      healthy: number of recordings of the healthy robot.
    """

    values: int
    shared: float
    single: float
    diagnosed: int
    healthy: int


def may_be_no_change(gains: Gains, candidates: int) -> bool:
    """Whether recordings of one robot differ by more than noise, and may by so much.

    The values of one recording do not count as independent. `candidates` is the number
    of effects at their places of which the best ones were chosen.
    """
    free = gains.diagnosed + gains.healthy - 2
    if free < 1 or chi2.sf(2 * gains.single, gains.values * free) > LEVEL:
        return False
    known = gains.healthy / (gains.diagnosed + gains.healthy)
    ratio = gains.shared * known * free / max(gains.single, 1e-12)
    return bool(f.sf(ratio, gains.values, free) > LEVEL / max(candidates, 1))


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
    gains = [_gains(both, healthy, fitted, group) for group in groups]
    doubtful = [i for i, one in enumerate(gains) if may_be_no_change(one, count)]
    if not doubtful and len(groups) > 1:
        lasting = tuple(one for group in groups for one in group)
        whole = _gains(both, healthy, fitted, lasting)
        doubtful = [*range(len(groups))] if may_be_no_change(whole, count) else []
    if not doubtful:
        return None
    return groups[min(doubtful, key=lambda i: gains[i].shared)]


def _gains(
    both: Predictor, healthy: Sequence[Predictor], fitted: FittedModel, group: Model
) -> Gains:
    """What effects gain beside the others of a fit, shared and in single recordings."""
    single, diagnosed, before = 0.0, 0, 0
    left, change = fitted.residual, fitted.jacobian_of(group)
    for own in _recordings(both):
        entries = np.isin(both.trace, own)
        single += _explained(left[entries], change[entries])
        diagnosed += 1
    for one in healthy:
        for own in _recordings(one):
            some = one.part(own[0], own[-1] + 1)
            gain = _energy(some, ()) - fit_all(some, [tuple(group)])[0].energy
            single += max(gain, 0.0)
            before += 1
    shared = max(_without(both, fitted, group) - fitted.energy, 0.0)
    return Gains(number_of_values(tuple(group)), shared, single, diagnosed, before)


def _without(both: Predictor, fitted: FittedModel, group: Model) -> float:
    """Energy [nats] without some effects of a fit, the others refitted linearly."""
    less = tuple(one for one in fitted.model if one not in group)
    (left,) = both.residuals([less])
    taken = _explained(left, fitted.jacobian_of(less)) if less else 0.0
    return 0.5 * float(left @ left) - taken


def _energy(some: Predictor, model: Model) -> float:
    (left,) = some.residuals([model])
    return 0.5 * float(left @ left)


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
