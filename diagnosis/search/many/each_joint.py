"""Searches for many effects, at each joint by itself.

Effects are chosen at once by linear estimates (`stepwise.py`), fitted by replays, and
chosen again beside what was found, until no more and no others make the model better.
"""

from collections.abc import Sequence

from diagnosis.effects.library import all_effects
from diagnosis.residuals.bursts import push_intervals
from diagnosis.residuals.signatures import Signature, signatures
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.known_changes import KnownChanges
from diagnosis.search.many.stepwise import Stepwise
from diagnosis.search.result import Judged
from diagnosis.search.screening import Screen

BEGUN = 5
"""Number of models that are fitted in the first round, from which the best goes on."""

EXCHANGED = 8
"""Number of models with other effects in place of some that are fitted in a round."""


def each_joint(fits: Fits) -> Judged:
    """The model with effects at each joint by itself, as far as it gets better."""
    return fits.improved("each joint", _more_detailed)


def _more_detailed(fits: Fits, best: Judged) -> Judged | None:
    """A better model with more or other effects; None if there is none.

    What does not last is tried where nothing else helps any more.
    """
    lasting = fits.allowed(lasting_effects())
    found = signatures(fits.fit, best.model, fits.usage, (), lasting)
    step = _step(fits, best, found)
    known = KnownChanges(fits.fit, best.fit, found)
    other = _with_more(fits, best, step, known)
    other = other or _with_others(fits, best, step, known)
    short = push_intervals(fits.fit, best.fit.residual)[1:]
    if other or not short:
        return other
    kinds = (name for name, kind in all_effects().items() if kind.timed)
    found = signatures(fits.fit, best.model, fits.usage, short, fits.allowed(kinds))
    known = KnownChanges(fits.fit, best.fit, found)
    return _with_more(fits, best, _step(fits, best, found), known) if found else None


def _step(fits: Fits, best: Judged, found: Sequence[Signature]) -> Stepwise:
    screen, floor = Screen(fits.fit, found), fits.fit.noise_energy
    return Stepwise(screen, fits.ebic(best), best, floor)


def _with_more(
    fits: Fits, best: Judged, step: Stepwise, known: KnownChanges
) -> Judged | None:
    """The model with effects beside its own; None if none makes it better."""
    # linear estimates are roughest beside no effect, and later ones begin from there
    added = step.models(1 if best.model else BEGUN)
    starts = [(*best.model, *one) for one in added]
    tried = fits.tried(starts, [known.jacobian(one) for one in starts])
    if not tried:
        return None
    larger = fits.fitted(tried[0].model)
    return larger if fits.is_better(larger, best) else None


def _with_others(
    fits: Fits, best: Judged, step: Stepwise, known: KnownChanges
) -> Judged | None:
    """The model with other effects in place of some; None if none is better."""
    starts = step.exchanged()[:EXCHANGED]
    tried = fits.tried(starts, [known.jacobian(one) for one in starts])
    if not (tried and fits.ebic(tried[0]).prefers(tried[0], best)):
        return None
    return fits.fitted(tried[0].model)


def lasting_effects() -> tuple[str, ...]:
    """Names of the effects that act in all of a recording."""
    return tuple(name for name, kind in all_effects().items() if not kind.timed)
