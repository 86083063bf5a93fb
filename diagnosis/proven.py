"""Whether what a search found is new, or was a matter of which steps were taken.

A walking robot's model is wrong in other ways at each step. What explains some of that
by chance gains much at some moments and loses at others, and would have gained when all
was well. What has changed gains at most moments, and much more than it did before.
"""

from dataclasses import replace

import numpy as np

from diagnosis.predictor import Model, Predictor
from diagnosis.search import Search
from diagnosis.search_result import Found
from groundwalk.arrays import FloatArray

SURE = 3.0
"""Standard errors by which the gain exceeds what there was before."""


def proven(search: Search, found: Found) -> Found:
    """What a search came to, less the effects that may have been there before.

    Args:
      search: that has run; without recordings of when all was well nothing is asked.
      found: what it came to.
    """
    chosen = found.chosen
    while search.well and chosen:
        less = found.best[chosen - 1][0].model if chosen > 1 else ()
        if _is_new(search, less, found.best[chosen][0].model):
            break
        chosen -= 1
    return replace(found, chosen=chosen)


def _is_new(search: Search, less: Model, more: Model) -> bool:
    """Whether a model gains over a smaller one as it would not have done before."""
    now = _gains(search.select, less, more)
    before = np.concatenate([_gains(well, less, more) for well in search.well])
    share = _scored(search.select) / sum(_scored(well) for well in search.well)
    gain, variance = float(now.sum()), len(now) * float(now.var())
    if before.sum() > 0:
        gain -= share * float(before.sum())
        variance += share**2 * len(before) * float(before.var())
    return bool(gain > SURE * np.sqrt(variance))


def _scored(predictor: Predictor) -> float:
    return float(predictor.scored.sum())


def _gains(predictor: Predictor, less: Model, more: Model) -> FloatArray:
    """(blocks,) log-likelihood that a model gains over another, moment by moment."""
    residuals = predictor.residuals([less, more])
    gains = 0.5 * (residuals[0] ** 2 - residuals[1] ** 2)
    return np.asarray(np.bincount(predictor.block, gains), float)
