"""How sure a search's answer is, and what else it may be."""

import numpy as np

from diagnosis.effects.library import effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.search.result import SearchResult
from diagnosis.verdict.verdict import EffectAt, VerdictKind

TIED_NATS = 10.0
"""What is less plausible by no more than that may be the truth as well: residuals are
alike from row to row, so that they tell less than their number."""

SLOPE, EVEN_NATS = 1.0, 3.0
"""Of the log odds that an effect is right, over the logarithm of the gap to the next
other effect, which hardly counts up to so many nats; even odds where there is no gap.
From 39 answers to concealed cases (seed 777, 38 of them right; without cases that were
not excited): slopes of 0.8 to 1.5 explain these about as well."""

MOST = 0.98
"""However large the gap: what no effect of the library is can look like one."""


def confusable(found: SearchResult, placed: PlacedEffect) -> tuple[EffectAt, ...]:
    """Effects that would do as well in the stead of one of the winner's."""
    winner = found.winner
    assert winner is not None
    rest = winner.keys - {placed.key}
    others: dict[str, EffectAt] = {}
    for judged in found.best[found.chosen]:
        own = [other for other in judged.model if other.key not in rest]
        other = len(own) == 1 and own[0].key != placed.key
        if other and found.worse(judged) <= TIED_NATS:
            others[own[0].key] = EffectAt(own[0].name, own[0].place)
    return tuple(others.values())


def twins(plant: Plant, placed: PlacedEffect) -> tuple[EffectAt, ...]:
    """Effects that no recording of this robot can distinguish from the given one."""
    others = effect(placed.name).twins(plant, placed.place)
    return tuple(EffectAt(other.name, other.place) for other in others)


def alternatives(
    found: SearchResult, kind: VerdictKind
) -> tuple[tuple[EffectAt, ...], ...]:
    """Whole other answers of the chosen size that do as well.

    Where the data cannot tell, the one that does best is but one of them.
    """
    winner = found.winner
    if winner is None:
        return ()
    tied = [one for one in found.best[found.chosen] if found.worse(one) <= TIED_NATS]
    every = {one.keys: one.model for one in (winner, *tied)}
    answers = tuple(
        tuple(EffectAt(placed.name, placed.place) for placed in model)
        for model in every.values()
    )
    return answers if kind == "not_identifiable" else answers[1:]


def gap(found: SearchResult, placed: PlacedEffect) -> float:
    """How much worse the best model without an effect of the winner is [nats].

    Infinite if none was tried.
    """
    same = {placed.key, *(grown.key for grown in grown_from(placed))}
    without = [
        found.worse(other)
        for size, models in found.best.items()
        for other in models
        if size <= found.chosen and not same & other.keys
    ]
    return max(min(without, default=np.inf), 0.0)


def probability(found: SearchResult, placed: PlacedEffect) -> float:
    """That an effect of the winner is right, from the gap to models without it."""
    odds = SLOPE * np.log1p(gap(found, placed) / EVEN_NATS)
    return float(MOST / (1 + np.exp(-odds)))
