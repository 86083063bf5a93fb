"""Computes how probable each found effect is, and which others may be the truth."""

import numpy as np

from diagnosis.effects.library import effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.search.result import SearchResult
from diagnosis.verdict import VerdictKind

TIED_NATS = 10.0
"""Models that are less plausible than the best one by at most this [nats] may be the
truth as well. It is large since residuals of neighbouring rows are correlated."""

SLOPE, EVEN_NATS = 1.0, 3.0
"""The log odds that a found effect is right are SLOPE ln(1 + gap / EVEN_NATS), the gap
being the distance [nats] to the best model without it. Calibrated on 39 diagnoses of
hidden physics (seed 777, 38 right; those in which the joints did not move enough left
out); slopes of 0.8 to 1.5 describe these about as well."""

MOST = 0.98
"""Largest probability that is stated for an effect: physics that the library of effects
lacks can look like one of them."""


def confusable(found: SearchResult, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
    """Effects that could replace `placed` in the winning model and explain as much."""
    winner = found.winner
    assert winner is not None
    rest = winner.keys - {placed.key}
    others: dict[str, PlacedEffect] = {}
    for judged in found.best[found.chosen]:
        own = [other for other in judged.model if other.key not in rest]
        other = len(own) == 1 and own[0].key != placed.key
        if other and found.worse(judged) <= TIED_NATS:
            others[own[0].key] = PlacedEffect(own[0].name, own[0].place)
    return tuple(others.values())


def alike(
    found: SearchResult, plant: Plant, placed: PlacedEffect
) -> tuple[PlacedEffect, ...]:
    """Effects that may be true instead of `placed`, in these or in any recordings."""
    twins = effect(placed.name).twins(plant, placed.place)
    return tuple(dict.fromkeys((*confusable(found, placed), *twins)))


def alternatives(
    found: SearchResult, kind: VerdictKind
) -> tuple[tuple[PlacedEffect, ...], ...]:
    """Other models with as many effects as the winner that explain the data as well.

    For the verdict "not_identifiable" the winner is included.
    """
    winner = found.winner
    if winner is None:
        return ()
    tied = [one for one in found.best[found.chosen] if found.worse(one) <= TIED_NATS]
    every = {one.keys: one.model for one in (winner, *tied)}
    answers = tuple(
        tuple(PlacedEffect(placed.name, placed.place) for placed in model)
        for model in every.values()
    )
    return answers if kind == "not_identifiable" else answers[1:]


def gap(found: SearchResult, placed: PlacedEffect) -> float:
    """How much less plausible [nats] the best model without an effect is.

    At least 0, compared with the winner; infinite if no model without it was tried.
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
    """Probability, 0.49 to 0.98, that an effect of the winning model is right."""
    odds = SLOPE * np.log1p(gap(found, placed) / EVEN_NATS)
    return float(MOST / (1 + np.exp(-odds)))
