"""The best models of a search once more, on equal terms."""

from collections.abc import Sequence
from dataclasses import replace

from diagnosis.effects.effect import PlacedEffect
from diagnosis.residuals.predictor import Model
from diagnosis.search.fitting import fit_all
from diagnosis.search.result import Found, Judged, keys_of
from diagnosis.search.search import Search
from groundwalk.arrays import FloatArray

CLOSE_NATS = 100.0
"""What is worse by no more may have an effect that belongs to the best model."""


def compared(search: Search, found: Found) -> Found:
    """What a search came to, the best models with the integrator's error of each.

    In the search it is that of the model that was best, and the values of others have
    to make up for it. Models that come close may each have a part of the answer: so
    their effects are also tried in the best one's stead.

    Args:
      search: that has run.
      found: what it came to.
    """
    if found.winner is None:
        return found
    close = found.best[found.chosen][: search.rules.compared]
    rest = found.best[found.chosen][len(close) :]
    again = fairly(
        search, [one.model for one in close], [one.fit.jacobian for one in close]
    )
    best = replace(
        found, best={**found.best, found.chosen: search.ranked([*again, *rest])}
    )
    more = fairly(search, crossed(best)[: search.rules.compared])
    every = search.ranked([*best.best[found.chosen], *more])
    return replace(found, best={**found.best, found.chosen: every})


def fairly(
    search: Search,
    models: Sequence[Model],
    jacobians: Sequence[FloatArray | None] | None = None,
) -> list[Judged]:
    """Fitted a little further and judged, each with its own integrator's error.

    Args:
      search: that has run.
      models: with values that are nearly right.
      jacobians: there, where they are known.
    """
    if not models:
        return []
    fits = fit_all(
        search.fit,
        models,
        search.rules.first_steps,
        followed=True,
        jacobians=jacobians,
        exactly=True,
    )
    return search.judge(fits, exactly=True)


def crossed(found: Found) -> list[Model]:
    """The best model with one effect exchanged for one of a model that comes close."""
    winner, every = found.winner, found.best[found.chosen]
    assert winner is not None
    others: dict[str, PlacedEffect] = {
        placed.key: placed
        for one in reversed(every)
        if found.worse(one) <= CLOSE_NATS
        for placed in one.model
    }
    known = {one.keys for one in every if found.worse(one) <= CLOSE_NATS}
    models: dict[frozenset[str], Model] = {}
    for old in winner.model:
        for other in others.values():
            model = tuple(other if one is old else one for one in winner.model)
            keys = keys_of(model)
            if len(keys) == len(model) and keys not in known:
                models.setdefault(keys, model)
    return list(models.values())
