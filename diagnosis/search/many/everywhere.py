"""Searches for effects at many joints, and says whether they are better than few.

The search for one, two or three effects suits a robot whose model was right once. Where
many joints are off, effects are looked for at each joint by itself. Where that does not
lead to the noise, no model of the robot is exact, and many values would fit its errors:
then the values that joints share come first. What chance may explain is taken out
again. The extended Bayesian information criterion decides (`ebic.py`).
"""

import numpy as np

from diagnosis.residuals.predictor import Model
from diagnosis.residuals.ties import without_each
from diagnosis.residuals.torques.asked_torques import FAR
from diagnosis.search.fitting import fit_all
from diagnosis.search.judging import Judge
from diagnosis.search.many.each_joint import each_joint
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.in_torques import (
    best_in_torques,
    from_asked_torques,
    may_be_noise,
)
from diagnosis.search.many.pruning import pruned, shared
from diagnosis.search.many.shared_first import shared_first
from diagnosis.search.result import Judged, SearchResult

MUCH_BETTER = 0.25
"""A model with effects at all joints is preferred to one of up to three effects if it
removes this share of the energy above the noise that the latter leaves."""


def everywhere(
    judge: Judge, result: SearchResult, promising: Model = ()
) -> SearchResult:
    """The model with effects at all joints and others if it fits much better.

    `result` is that of the search for few effects, which is returned otherwise.
    `promising` is a model to begin with, () for none.
    """
    search = Fits(judge, weighs=is_far(judge, result))
    best = best_of_all(search, promising)
    nothing = search.nominal()
    winner = search.fitted(result.winner.model) if result.winner else nothing
    few = min(winner.energy, _beside_small_mismatch(judge, result))
    left = few - best.energy
    floor = search.judge.floor + search.judge.floor_fit
    much = max(MUCH_BETTER * (few - floor), search.judge.least_gain)
    if not best.model or left < much:
        return result
    judge.least_gain = search.judge.least_gain
    size = len(best.model)
    smaller = without_each(best.model)
    known = [best.fit.jacobian_of(model) for model in smaller]
    steps = judge.rules.first_steps
    fits = fit_all(search.fit, smaller, steps, followed=True, jacobians=known)
    sizes = {
        size - 1: search.judge.ranked(search.judge.judge(fits)),
        size: [best],
    }
    return SearchResult(
        nothing.selected,
        search.judge.floor,
        sizes,
        size,
        nothing.fit.energy,
        search.judge.floor_fit,
    )


def _beside_small_mismatch(judge: Judge, result: SearchResult) -> float:
    """Energy that few effects leave where the model has small mismatch as well [nats].

    That mismatch is everywhere, too, and not worth a name. Infinite where it is too
    small to explain what is left, and beside no effect, for which it may stand.
    """
    nuisance = judge.fit.nuisance
    if result.winner is None or nuisance is None or not nuisance.sizes.any():
        return np.inf
    return judge.again([result.winner])[0].energy


def is_far(judge: Judge, few: SearchResult) -> bool:
    """Whether few effects leave many times the noise, beside small mismatch."""
    energy = few.winner.energy if few.winner else few.nothing + few.nothing_fit
    return bool(energy > FAR**2 * (judge.floor + judge.floor_fit))


def best_of_all(fits: Fits, promising: Model = ()) -> Judged:
    """The best model; without effects if none explains much at many joints.

    Where replays are far from the noise, so that recordings are weighed, a search
    begins with a `promising` model, or with models of the torques that servos ask for,
    if these are known.
    """
    if fits.fit.by_torque:
        return best_in_torques(fits)
    if fits.weighs and promising:
        return pruned(fits, shared_first(fits, promising))
    best = from_asked_torques(fits) if fits.weighs else None
    if best is not None:
        return best
    detailed = each_joint(fits)
    if not may_be_noise(fits, detailed):
        return pruned(fits, shared_first(fits))
    return pruned(fits, shared(fits, detailed))
