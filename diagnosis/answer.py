"""What a search's outcome means: the kind of verdict, and the effects believed."""

from collections.abc import Sequence

from diagnosis.audit_result import Audit
from diagnosis.belief import confusable, probability, twins
from diagnosis.effect import Placed
from diagnosis.estimates import estimates
from diagnosis.fitting import Fit as FittedModel
from diagnosis.library import effect
from diagnosis.plant import Plant
from diagnosis.predictor import Predictor
from diagnosis.search_result import Found as Searched
from diagnosis.verdict import EffectAt, Found, VerdictKind, When

LEAST_CLOSED = 0.95
"""A model that takes away less of the energy above the noise is not all there is ..."""

MOST_LEFT = 0.5
"""... unless what it leaves is below so large a part of the noise's own energy."""


def kind_of(searched: Searched, plant: Plant, audited: Audit) -> VerdictKind:
    """The kind of verdict.

    Args:
      searched: what the search came to.
      plant: nominal.
      audited: says which joints moved.
    """
    energy = searched.winner.selected if searched.winner else searched.nothing
    left = energy - searched.floor
    closed = searched.closed(searched.winner) if searched.winner else 0.0
    if left > MOST_LEFT * searched.floor and closed < LEAST_CLOSED:
        return "unknown"
    if searched.winner:
        return "effects"
    still = [joint for joint in plant.joints if joint not in audited.moving]
    return "not_identifiable" if still else "none"


def effects_of(
    both: Predictor, searched: Searched, refitted: FittedModel | None
) -> tuple[Found, ...]:
    """The effects believed, the surest first.

    Args:
      both: predicts the data learned from.
      searched: what the search came to.
      refitted: its model, fitted to all of these data; None for no effect.
    """
    if refitted is None or searched.winner is None:
        return ()
    values = estimates(both, refitted)
    found = [
        Found(
            name=placed.effect,
            place=placed.place,
            parameters=own,
            probability=probability(searched, placed),
            confusable_with=_distinct(
                confusable(searched, placed) + twins(both.plant, placed)
            ),
            when=_when(both, placed),
            native=effect(placed.effect).native,
        )
        for placed, own in zip(refitted.model, values, strict=True)
    ]
    return tuple(sorted(found, key=lambda one: -one.probability))


def _distinct(effects: Sequence[EffectAt]) -> tuple[EffectAt, ...]:
    return tuple(dict.fromkeys(effects))


def _when(both: Predictor, placed: Placed) -> When:
    first_s = min(trace.time_s[0] for trace in both.traces)
    last_s = max(trace.time_s[-1] for trace in both.traces)
    if placed.effect == "servo_fade":
        return When("drift", float(first_s), float(last_s))
    if placed.effect == "external_force":
        start_s, duration_s = placed.values[3:]
        if start_s > first_s or start_s + duration_s < last_s:
            return When("burst", start_s, start_s + duration_s)
    return When()
