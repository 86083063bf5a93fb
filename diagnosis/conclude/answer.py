"""Decides the kind of verdict that follows from a search, and how sure it is."""

from dataclasses import replace

import numpy as np

from diagnosis.audit.result import Audit
from diagnosis.conclude.estimates import estimates
from diagnosis.effects.library import containing, effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.small_mismatch.usual_errors import is_usual
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import FittedModel
from diagnosis.search.many.losses import Losses
from diagnosis.search.result import Judged, SearchResult
from diagnosis.verdict import Found, VerdictKind, When

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


def alike(
    found: SearchResult, plant: Plant, placed: PlacedEffect
) -> tuple[PlacedEffect, ...]:
    """Effects that may be true instead of `placed`, in these or in any recordings.

    They could replace it in the winning model and explain as much, or are its twins.
    More general forms of it always explain as much, and are left out.
    """
    winner = found.winner
    others: dict[str, PlacedEffect] = {}
    if winner is not None and placed.key in winner.keys:
        rest, same = winner.keys - {placed.key}, {placed.key, *containing(placed)}
        for judged in found.best[found.chosen]:
            own = [other for other in judged.model if other.key not in rest]
            other = len(own) == 1 and own[0].key not in same
            if other and found.worse(judged) <= TIED_NATS:
                others[own[0].key] = PlacedEffect(own[0].name, own[0].place)
    twins = effect(placed.name).twins(plant, placed.place)
    return tuple(dict.fromkeys((*others.values(), *twins)))


def rivals(found: SearchResult) -> list[Judged]:
    """Other models with as many effects as the winner that explain the data as well.

    The most plausible one is first. Models that only have more general forms of the
    winner's effects are none: they always explain as much.
    """
    winner = found.winner
    if winner is None:
        return []
    same = {key for placed in winner.model for key in containing(placed)} | winner.keys
    return [
        one
        for one in found.best[found.chosen]
        if found.worse(one) <= TIED_NATS and not one.keys <= same
    ]


def alternatives(
    found: SearchResult, kind: VerdictKind
) -> tuple[tuple[PlacedEffect, ...], ...]:
    """The effects of the winner's rivals: of models that explain the data as well.

    For the verdict "not_identifiable" the winner is included.
    """
    winner = found.winner
    if winner is None:
        return ()
    every = {one.keys: one.model for one in (winner, *rivals(found))}
    answers = tuple(
        tuple(PlacedEffect(placed.name, placed.place) for placed in model)
        for model in every.values()
    )
    return answers if kind == "not_identifiable" else answers[1:]


def gap(found: SearchResult, placed: PlacedEffect) -> float:
    """How much less plausible [nats] the best model without an effect is.

    At least 0, compared with the winner; infinite if no model without it was tried.
    """
    same = {placed.key, *containing(placed)}
    without = [
        found.worse(other)
        for size, models in found.best.items()
        for other in models
        if size <= found.chosen and not same & other.keys
    ]
    return max(min(without, default=np.inf), 0.0)


def probability(nats: float) -> float:
    """Probability, 0.49 to 0.98, that an effect is right.

    `nats` is how much less plausible the best model without it is.
    """
    odds = SLOPE * np.log1p(nats / EVEN_NATS)
    return float(MOST / (1 + np.exp(-odds)))


def is_small(plant: Plant, placed: PlacedEffect) -> bool:
    """Whether an effect is an error of what the robot model states, of usual size.

    Dry friction, which models leave out, is missing and not small.
    """
    return is_usual(plant, placed) and not effect(placed.name).jumps


LEAST_CLOSED = 0.5
"""Share of the nominal sim's energy (half the sum of squared residuals) above the noise
that a model must remove; with less, more is missing and the verdict is `unknown`."""


def verdict_kind(searched: SearchResult, plant: Plant, audited: Audit) -> VerdictKind:
    """The kind of verdict: "effects", "none", "unknown" or "not_identifiable"."""
    winner = searched.winner
    if searched.leaves_much(LEAST_CLOSED):
        return "unknown"
    still = set(plant.joints) - audited.moving
    at_rest = still | plant.at_rest(still)
    if winner and not {one.place for one in winner.model} <= at_rest:
        return "effects"
    return "not_identifiable" if still else "none"


def believed_effects(
    both: Predictor, searched: SearchResult, refitted: FittedModel | None
) -> tuple[Found, ...]:
    """The effects of a verdict with estimates, the most probable first.

    `refitted` is the search's winner fitted to the data of `both`, which simulates
    fitting and selection data; None if it has no effect. Effects that the search did
    not find are small mismatch of the model that is sure.
    """
    if refitted is None:
        return ()
    known = searched.winner.keys if searched.winner else frozenset()
    gains = {
        one.key: gain for own, gain in Losses(refitted).without_each() for one in own
    }
    values = estimates(both, refitted)
    first_s = min(float(trace.time_s[0]) for trace in both.traces)
    last_s = max(float(trace.time_s[-1]) for trace in both.traces)
    found = [
        Found(
            name=placed.name,
            place=placed.place,
            parameters=own,
            probability=probability(
                gap(searched, placed) if placed.key in known else gains[placed.key]
            ),
            confusable_with=alike(searched, both.plant, placed),
            when=_when(placed, first_s, last_s),
            native=effect(placed.name).native,
            shared_with=_sharing(placed, refitted),
        )
        for placed, own in zip(refitted.model, values, strict=True)
    ]
    return tuple(sorted(found, key=lambda one: -(one.probability or 0.0)))


def _sharing(placed: PlacedEffect, fitted: FittedModel) -> tuple[str, ...]:
    """Other places at which an effect of a fit has the same values, being tied."""
    (group,) = (group for group in groups_of(fitted.model) if placed in group)
    return tuple(one.place for one in group if one is not placed)


def _when(placed: PlacedEffect, first_s: float, last_s: float) -> When:
    """When an effect acted in recordings that last from `first_s` to `last_s`."""
    when = effect(placed.name).acted(placed, first_s, last_s)
    return replace(when, recording=placed.recording)
