"""Decides the kind of verdict that follows from a search, and its effects."""

from dataclasses import replace

from diagnosis.audit.result import Audit
from diagnosis.conclude.confidence import alike, gap, probability
from diagnosis.conclude.estimates import estimates
from diagnosis.effects.library import effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import FittedModel
from diagnosis.search.result import SearchResult
from diagnosis.verdict import Found, VerdictKind

LEAST_CLOSED = 0.95
"""Share of the nominal sim's energy (half the sum of squared residuals) above the noise
that a model must remove; with less, more is missing and the verdict is `unknown`."""

MOST_LEFT = 0.5
"""If the error energy that remains exceeds that of the noise by at most this share of
it, hardly more than noise remains, and the verdict is not `unknown`."""


UNSURE_NATS = 15.0
"""An effect is unsure if leaving it out lowers the log-likelihood by less than this."""
WEAK = 4.0
"""An unsure effect stays in the answer only if it improves the fit by this many times
the gain that is asked of other effects."""


def without_unsure(searched: SearchResult, least_gain: float) -> SearchResult:
    """Remove the effect that was added last if it is neither certain nor a large gain.

    Two simulators of the same physics always differ a little, and some effect always
    explains a part of the difference. The only effect of a model stays. `least_gain`
    [nats] is the gain that the search required of each effect.
    """
    winner = searched.winner
    if winner is None or searched.chosen == 1:
        return searched
    least = min(gap(searched, placed) for placed in winner.model)
    smaller = searched.best[searched.chosen - 1][0]
    weak = smaller.selected - winner.selected < WEAK * least_gain
    if least >= UNSURE_NATS or not weak or not smaller.keys < winner.keys:
        return searched
    return without_unsure(replace(searched, chosen=searched.chosen - 1), least_gain)


def verdict_kind(searched: SearchResult, plant: Plant, audited: Audit) -> VerdictKind:
    """The kind of verdict: "effects", "none", "unknown" or "not_identifiable"."""
    selected, fitted, closed = searched.nothing, searched.nothing_fit, 0.0
    winner = searched.winner
    if winner:
        selected, fitted = winner.selected, winner.fit.energy
        closed = searched.closed(winner)
    much = selected > (1 + MOST_LEFT) * searched.floor
    much |= fitted > (1 + MOST_LEFT) * searched.floor_fit
    if much and closed < LEAST_CLOSED:
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
    fitting and selection data; None if it has no effect.
    """
    if refitted is None or searched.winner is None:
        return ()
    values = estimates(both, refitted)
    first_s = min(float(trace.time_s[0]) for trace in both.traces)
    last_s = max(float(trace.time_s[-1]) for trace in both.traces)
    found = [
        Found(
            name=placed.name,
            place=placed.place,
            parameters=own,
            probability=probability(searched, placed),
            confusable_with=alike(searched, both.plant, placed),
            when=effect(placed.name).acted(placed, first_s, last_s),
            native=effect(placed.name).native,
        )
        for placed, own in zip(refitted.model, values, strict=True)
    ]
    return tuple(sorted(found, key=lambda one: -one.probability))
