"""Whether what a search found is new, or was a matter of which steps were taken.

A walking robot's model is wrong in other ways at each step. What explains some of that
by chance gains much at some moments and loses at others, and would have gained when all
was well. What has changed gains at most moments, and much more than it did before.
"""

from dataclasses import replace

import numpy as np

from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.result import Found
from diagnosis.search.search import Search
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
    # a few seconds each: neither has enough moments for itself
    now = np.concatenate(
        [_gains(part, less, more) for part in (search.fit, search.select)]
    )
    before = np.concatenate([_gains(well, less, more) for well in search.well])
    usual = max(float(before.mean()), 0.0)
    variance = now.var() / len(now) + before.var() / len(before)
    return bool(now.mean() - usual > SURE * np.sqrt(variance))


def _gains(predictor: Predictor, less: Model, more: Model) -> FloatArray:
    """(blocks,) what a model gains over another, moment by moment, in standard errors.

    Roots of log-likelihoods, with their signs: a squat shows much more at some moments
    than at others, which is no reason to doubt it.
    """
    residuals = predictor.residuals([less, more])
    gains = 0.5 * (residuals[0] ** 2 - residuals[1] ** 2)
    every = np.bincount(predictor.block, gains)
    return np.asarray(np.sign(every) * np.sqrt(2 * np.abs(every)))
