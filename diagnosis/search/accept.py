"""The tests after a search that decide which of its effects are reported.

`accepted` applies three tests in this order. The best models are compared again, each
with its own integration error. Values and effects that the best one does not need are
removed. Of a robot on its feet, effects that gain at few moments, or as much on
recordings of the healthy robot, are removed, too (`steady_gains.py`).
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from diagnosis.effects.library import effect
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.ties import without_each
from diagnosis.search.fitting import fit_all
from diagnosis.search.judging import Judge
from diagnosis.search.result import Judged, SearchResult, keys_of
from diagnosis.search.steady_gains import with_steady_gains
from groundwalk.arrays import FloatArray

CLOSE_NATS = 100.0
"""Effects of models that are less plausible than the best one by at most this [nats]
are tried in it. The number is large since trying a few more models is cheap."""

REPLAYS_EACH = 30
"""Rough number of simulations of the recordings in the tests after a search, for each
model compared; only for the progress display."""


def accepted(judge: Judge, result: SearchResult) -> SearchResult:
    """The result of a search without effects and values that fail a closer test."""
    judge.hooks.stage("comparison", REPLAYS_EACH * judge.rules.compared)
    result = compared_exactly(judge, result)
    result = without_idle_effects(judge, without_idle_values(judge, result))
    return with_steady_gains(judge, result)


def compared_exactly(judge: Judge, result: SearchResult) -> SearchResult:
    """Rank the best models again, each with its own integration error.

    During the search all models share that of the model that was best at that time,
    which distorts the values of the others. Models that come close may each contain a
    part of the answer, so their effects are also tried in place of those of the best
    model.
    """
    if result.winner is None:
        return result
    size, count = result.chosen, judge.rules.compared
    close, others = result.best[size][:count], result.best[size][count:]
    jacobians = [one.fit.jacobian for one in close]
    again = fitted_exactly(judge, [one.model for one in close], jacobians)
    result = result.with_models(size, judge.ranked([*again, *others]))
    more = fitted_exactly(judge, recombined(result)[:count])
    return result.with_models(size, judge.ranked([*result.best[size], *more]))


def fitted_exactly(
    judge: Judge,
    models: Sequence[Model],
    jacobians: Sequence[FloatArray | None] | None = None,
) -> list[Judged]:
    """Fit and judge models, each corrected by its own integration error.

    The values of the models are already close to the best ones. `jacobians` (N, p) are
    those at these values; None if unknown.
    """
    if not models:
        return []
    steps = judge.rules.first_steps
    fit = partial(fit_all, judge.fit, models, steps, followed=True, jacobians=jacobians)
    return judge.saved(lambda: judge.judge(fit(exactly=True), exactly=True))


def recombined(result: SearchResult) -> list[Model]:
    """Variants of the best model: one effect replaced by one of another good model."""
    winner, every = result.winner, result.best[result.chosen]
    assert winner is not None
    close = [one for one in every if result.worse(one) <= CLOSE_NATS]
    others = {placed.key: placed for one in reversed(close) for placed in one.model}
    known = {one.keys for one in close}
    models: dict[frozenset[str], Model] = {}
    for old in winner.model:
        for other in others.values():
            model = tuple(other if one is old else one for one in winner.model)
            keys = keys_of(model)
            if len(keys) == len(model) and keys not in known:
                models.setdefault(keys, model)
    return list(models.values())


def without_idle_values(judge: Judge, result: SearchResult) -> SearchResult:
    """Replace effects by simpler forms where their extra values improve too little.

    Dry friction with a Stribeck peak, for example, always fits a little better than dry
    friction alone, since the peak can take any shape. It is kept only if it improves
    the fit as much as one more effect must.
    """
    while result.winner is not None:
        starts = simpler_models(result.winner.model)
        if not starts:
            break
        simpler = [judged.model for judged in judge.judged(starts)]
        best = min(fitted_exactly(judge, simpler), key=lambda judged: judged.evidence)
        if judge.worth(best, result.winner):
            break
        others = [one for one in result.best[result.chosen] if one.keys != best.keys]
        result = result.with_models(result.chosen, [best, *others])
    return result


def simpler_models(model: Model) -> list[Model]:
    """Variants of a model with one effect replaced by a simpler form of it."""
    known = keys_of(model)
    return [
        tuple(simpler if other is placed else other for other in model)
        for placed in model
        for simpler in effect(placed.name).simpler(placed)
        if simpler.key not in known
    ]


def without_idle_effects(judge: Judge, result: SearchResult) -> SearchResult:
    """Remove effects without which the remaining ones fit as well.

    While models grow, an effect may compensate for an error in another one. It becomes
    superfluous once the other one has its right place and size.
    """
    while result.winner is not None and result.chosen > 1:
        winner = result.winner
        smaller = judge.judged(without_each(winner.model))
        kept = [judged.model for judged in smaller]
        best = min(fitted_exactly(judge, kept), key=lambda judged: judged.evidence)
        if judge.worth(best, winner):
            break
        size = result.chosen - 1
        others = [one for one in result.best.get(size, []) if one.keys != best.keys]
        result = replace(result.with_models(size, [best, *others]), chosen=size)
    return result
