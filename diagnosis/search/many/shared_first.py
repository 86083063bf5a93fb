"""Searches for physics that many joints lack, and for what is missing beside it.

The first model of a real robot lacks the same physics at every joint, and no model of
it is exact. Here kinds of effects are added one by one, each at all joints where it may
be: with values that all joints share, with one for each kind of motor, or with one for
each joint. Single effects are tried beside them.
"""

import itertools
from collections.abc import Sequence

from diagnosis.effects.library import all_effects
from diagnosis.residuals.bursts import push_intervals
from diagnosis.residuals.predictor import Model
from diagnosis.residuals.signatures import Signature, signatures
from diagnosis.residuals.ties import group_of, groups_of
from diagnosis.search.candidates import Candidates
from diagnosis.search.fitting import ran_into_bound
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.kinds import kinds_to_add
from diagnosis.search.many.known_changes import KnownChanges
from diagnosis.search.result import Judged
from diagnosis.search.screening import Screen
from diagnosis.search.spread import FEWEST

MOST_REPLACED = 3
"""Most times that a search goes on after kinds of effects were replaced by others."""

FINISHED = 3
"""Number of models in a round that are fitted to the end, until one is not worse and
has no new effect on a bound."""


def shared_first(fits: Fits, first: Model = ()) -> Judged:
    """The best model; without effects if none explains much at all joints.

    The search begins with the effects of the model `first`. Where other kinds of
    effects fit better in the end, it goes on from these: more may be missing beside
    them than beside what stood for them.
    """
    best = fits.improved("all joints", _larger, first)
    for _ in range(MOST_REPLACED):
        other = _replaced(fits, best)
        if {*map(group_of, other.model)} == {*map(group_of, best.model)}:
            break
        best = fits.improved("all joints, replaced", _larger, other.model)
    return best


def _larger(fits: Fits, best: Judged) -> Judged | None:
    """A better model with more effects or values; None if there is none.

    Joints with the same motor are alike until the recordings show that they are
    not: other effects and further values are tried where no value that they share
    helps any more.
    """
    kinds = fits.allowed(servo_effects())
    found = signatures(fits.fit, best.model, fits.usage, (), kinds)
    screen = Screen(fits.fit, found)
    shared, apart = kinds_to_add(fits.fit, screen, best, fits.without)
    known = KnownChanges(fits.fit, best.fit, found)
    larger = _best_of(fits, shared, best, known)
    if larger:
        return larger
    singles, more = _singles(fits, best, found)
    known = KnownChanges(fits.fit, best.fit, [*found, *more])
    return _best_of(fits, [*apart, *singles], best, known)


def _best_of(
    fits: Fits, models: Sequence[Model], best: Judged, known: KnownChanges
) -> Judged | None:
    """The most plausible of some models; None if all are worse than the best one.

    What is better at different joints is taken together. A model with a further
    value on a bound is none: something else is behind it.
    """
    tried = fits.tried(models, [known.jacobian(one) for one in models])
    better = [
        one.model
        for one in tried
        if fits.is_better(one, best) and not stopped(one, best)
    ]
    together = united(fits.fit.plant.joints, best.model, better)
    if better and together != better[0]:
        larger = fits.fitted(together)
        if fits.is_better(larger, best):
            return larger
    for each in tried[:FINISHED]:
        larger = fits.fitted(each.model)
        if not fits.is_better(larger, best):
            return None
        if not stopped(larger, best):
            return larger
    return None


def _singles(
    fits: Fits, best: Judged, found: Sequence[Signature]
) -> tuple[list[Model], list[Signature]]:
    """Models with one more single effect; none where no kind explains anything.

    Signatures of effects that any servo may have are known (`found`); also returns
    those of the others. What does not last is tried where a short error is left.
    """
    if not best.model:
        return [], []
    known = servo_effects()
    others = [one for one in fits.allowed(all_effects()) if one not in known]
    short = push_intervals(fits.fit, best.fit.residual)[1:]
    more = signatures(fits.fit, best.model, fits.usage, short, others)
    candidates = Candidates(fits.fit, [*found, *more], fits.judge.rules)
    fits.judge.least_gain = candidates.gain_by_chance(best.fit.residual)
    return candidates.larger([best], near=False, residual=None), more


def _replaced(fits: Fits, best: Judged) -> Judged:
    """The model with other kinds of effects instead of its own if they fit better.

    What was added first was compared with little else: friction that grows with the
    load may have stood for a different dry friction at each joint.
    """
    for name in sorted({group[0].name for group in groups_of(best.model)}):
        own = [placed for placed in best.model if placed.name == name]
        rest = tuple(placed for placed in best.model if placed.name != name)
        if len(own) < FEWEST or not rest:
            continue
        (base,) = fits.tried([rest], [best.fit.jacobian_of(rest)])
        kinds = fits.allowed(servo_effects())
        found = signatures(fits.fit, base.model, fits.usage, (), kinds)
        known = KnownChanges(fits.fit, base.fit, found)
        screen = Screen(fits.fit, found)
        every = itertools.chain(*kinds_to_add(fits.fit, screen, base, fits.without))
        models = [one for one in every if one != best.model]
        for tried in fits.tried(models, [known.jacobian(one) for one in models]):
            if not fits.ebic(best).prefers(tried, best):
                break
            if not stopped(tried, base):
                best = fits.exact(fits.fitted(tried.model))
                break
    return best


def stopped(larger: Judged, best: Judged) -> bool:
    """Whether a single effect that was added has run into a bound."""
    known = {placed.key for placed in best.model}
    new = [placed for placed in larger.model if placed.key not in known]
    return len(new) == 1 and ran_into_bound(larger.fit, new[0])


def united(joints: Sequence[str], best: Model, larger: Sequence[Model]) -> Model:
    """What larger models, the best first, have beside a model, at different joints.

    Of those that add something at the same joint only the first counts: they are
    alternatives. What is added elsewhere, such as a delay, concerns all joints.
    """
    known = {placed.key: placed.tied for placed in best}
    taken, model = set[str](), best
    for one in larger:
        new = {p.key: p for p in one if known.get(p.key) != p.tied}
        places = {placed.place for placed in new.values()}
        concerned = places if places <= set(joints) else set(joints)
        if concerned & taken:
            continue
        taken |= concerned
        gone = {*new, *(known.keys() - {placed.key for placed in one})}
        kept = [placed for placed in (model if model != best else one)]
        model = (*(p for p in kept if p.key not in gone), *new.values())
    return model


def servo_effects() -> tuple[str, ...]:
    """Names of the effects that an incomplete robot model may lack at every servo."""
    wide = ("joint", "commands", "encoders", "supply")
    return tuple(
        name
        for name, kind in all_effects().items()
        if kind.on_every_servo and kind.place_kind in wide
    )
