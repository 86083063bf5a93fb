"""Removes effects of a robot on its feet that are not new, or gain at few moments."""

from dataclasses import replace

import numpy as np

from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.judging import Judge
from diagnosis.search.result import SearchResult
from groundwalk.arrays import FloatArray

SURE = 3.0
"""Standard errors by which the gain of an effect on the diagnosed recordings must
exceed its gain on recordings of the healthy robot."""


def with_steady_gains(judge: Judge, result: SearchResult) -> SearchResult:
    """The result without effects that gain at few moments, or on the healthy robot too.

    Without recordings of the healthy robot, or on a fixed base, it stays as it is.

    The model of a walking robot is wrong in a different way at each step. An effect
    that fits some of these errors by chance gains much at some moments, loses at
    others, and gains on recordings of the healthy robot, too. A true change gains at
    most moments, and much more than it gains there.
    """
    if not judge.healthy or judge.fit.plant.base == "fixed":
        return result
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
