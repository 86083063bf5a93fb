"""Removes effects that are not new: recordings of the healthy robot show them, too."""

from dataclasses import replace

import numpy as np

from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import without_each
from diagnosis.search.judging import Judge
from diagnosis.search.result import SearchResult
from groundwalk.arrays import FloatArray

SURE = 3.0
"""Standard errors by which the gain of an effect on the diagnosed recordings must
exceed its gain on recordings of the healthy robot, on a floating base."""

OLD = 0.5
"""Share of its gain from which on an effect, on a fixed base, is not new if it gains
that on the healthy robot: what was there gains as much, what is new nothing."""


def without_old_effects(judge: Judge, result: SearchResult) -> SearchResult:
    """Remove effects that recordings of the healthy robot, if there are any, may show.

    Without such the result stays as it is.
    """
    if not judge.healthy:
        return result
    fixed = judge.fit.plant.base == "fixed"
    return (_on_fixed_base if fixed else _on_floating_base)(judge, result)


def _on_fixed_base(judge: Judge, result: SearchResult) -> SearchResult:
    """Remove effects that explain half as much of recordings of the healthy robot.

    They were too faint to be found there, but are no change: two gains have to differ,
    not only one of them to be significant.
    """
    while result.winner is not None:
        model = result.winner.model
        smaller = without_each(model)
        shares = [_share_known(judge, less, model) for less in smaller]
        if max(shares) < OLD:
            break
        size, less = result.chosen - 1, smaller[shares.index(max(shares))]
        if less:
            result = result.with_models(size, judge.judged([less]))
        result = replace(result, chosen=size if less else 0)
    return result


def _share_known(judge: Judge, less: Model, more: Model) -> float:
    """What the effects that only `more` has gain on the healthy robot.

    As a share of their gain in the diagnosed recordings, for as many rows.
    """
    own = tuple(one for one in more if one not in less)
    now, before = (
        sum(_gain(part, *models) for part in parts)
        / sum(int(part.scored.sum()) for part in parts)
        for parts, models in (
            ((judge.fit, judge.select), (less, more)),
            (judge.healthy, ((), own)),
        )
    )
    return before / max(now, 1e-12)


def _gain(predictor: Predictor, less: Model, more: Model) -> float:
    """Energy [nats] that `more` removes from what `less` leaves."""
    left = predictor.residuals([less, more])
    return 0.5 * float(np.sum(left[0] ** 2) - np.sum(left[1] ** 2))


def _on_floating_base(judge: Judge, result: SearchResult) -> SearchResult:
    """Remove effects that gain at few moments, or as much on the healthy robot.

    The model of a walking robot is wrong in a different way at each step. An effect
    that fits some of these errors by chance gains much at some moments, loses at
    others, and gains on recordings of the healthy robot, too. A true change gains at
    most moments, and much more than it gains there.
    """
    chosen = result.chosen
    while chosen:
        less = result.best[chosen - 1][0].model if chosen > 1 else ()
        if _is_new(judge, less, result.best[chosen][0].model):
            break
        chosen -= 1
    return replace(result, chosen=chosen)


def _is_new(judge: Judge, less: Model, more: Model) -> bool:
    """Whether `more` gains more over `less` than it does on the healthy robot."""
    # fitting and selection data together, since each has too few time blocks
    now, before = (
        np.concatenate([_gains(part, less, more) for part in parts])
        for parts in ((judge.fit, judge.select), judge.healthy)
    )
    usual = max(float(before.mean()), 0.0)
    variance = now.var() / len(now) + before.var() / len(before)
    return bool(now.mean() - usual > SURE * np.sqrt(variance))


def _gains(predictor: Predictor, less: Model, more: Model) -> FloatArray:
    """(blocks,) gains of `more` over `less` in each time block, as signed square roots.

    The root reduces the weight of single moments, such as a squat, at which an effect
    shows far more than at others.
    """
    residuals = predictor.residuals([less, more])
    gains = 0.5 * (residuals[0] ** 2 - residuals[1] ** 2)
    every = np.bincount(predictor.block, gains)
    return np.asarray(np.sign(every) * np.sqrt(2 * np.abs(every)))
