"""Many joints that lack the same: what all servos have, and a bare model has not.

A search for one, two or three effects suits a robot whose model once was right. The
bare model of a real robot lacks the same physics at every joint, differently large.
Here whole kinds are added, each at all joints where it explains something.
"""

from collections.abc import Sequence
from dataclasses import replace

from diagnosis.effects.effect import PlacedEffect
from diagnosis.effects.library import EFFECTS
from diagnosis.residuals.predictor import Model
from diagnosis.search.fitting import fit_all
from diagnosis.search.joint_wise import joint_wise
from diagnosis.search.result import Found, Judged
from diagnosis.search.screening import Guess, Screen
from diagnosis.search.search import Search
from diagnosis.search.signatures import signatures

KINDS = tuple(
    name
    for name, kind in EFFECTS.items()
    if kind.place_kind in ("joint", "commands", "encoders")
    and name not in ("joint_elasticity", "end_stop", "servo_fade")
)
"""What servos have. Stops and fading are single faults."""

MOST_KINDS, TRIED, LEAN = 6, 4, 3
"""Kinds in a model; those tried each time, and besides those that gain most a value."""

LEAST_SHARE = 0.1
"""Of the energy above the noise that is left: what a kind must take away ..."""

PATIENCE = 2
"""... or so many kinds together."""

MUCH_BETTER = 0.25
"""Part of what the best small model leaves that must go for so many effects."""


def widespread(search: Search, found: Found) -> Found:
    """A model of whole kinds, if it does much better than the search's; else that.

    Args:
      search: that has run.
      found: what it came to.
    """
    best: Judged | None = None
    model: Model = ()
    residual, energy = search.fit.residuals([()])[0], found.nothing_fit + found.nothing
    floor = found.floor_fit + found.floor
    waited = 0
    for _ in range(MOST_KINDS):
        signs = signatures(search.fit, model, search.usage, (), KINDS)
        guesses = Screen(search.fit, signs).singles(residual)
        added = _by_kind(guesses, search.least_gain, model)
        tried = _best(search, [(*model, *more) for more in added])
        if tried is None:
            break
        model, residual = tried.model, tried.fit.residual
        if energy - tried.energy >= LEAST_SHARE * (energy - floor):
            best, energy, waited = tried, tried.energy, 0
        else:  # it may take another kind to bring out what this one is good for
            waited += 1
        if waited == PATIENCE:
            break
    if best is not None:
        best = _without_idle(search, best)
    left = found.winner.selected if found.winner else found.nothing
    needed = max(MUCH_BETTER * (left - found.floor), search.least_gain)
    if best is None or left - best.selected < needed:
        return found
    rests = _rests(best.model)
    residuals = search.fit.residuals(rests)
    fits = [
        replace(best.fit, model=rest, residual=residual)
        for rest, residual in zip(rests, residuals, strict=True)
    ]
    size = len(best.model)
    sizes = {size - 1: search.ranked(search.judge(fits)), size: [best]}
    return replace(found, best=sizes, chosen=size)


def _best(search: Search, starts: Sequence[Model]) -> Judged | None:
    """The best of some models; only that one is fitted well.

    On fitting and selection data together: so few values are hardly fitted by chance,
    and what one joint shows in one motion may be in no other.
    """
    if not starts:
        return None
    rough = fit_all(search.fit, starts, search.rules.first_steps, nudges_of=joint_wise)
    start = min(search.judge(rough), key=lambda one: one.energy).model
    (judged,) = search.judge(fit_all(search.fit, [start], nudges_of=joint_wise))
    return judged


def _without_idle(search: Search, best: Judged) -> Judged:
    """The model less what makes no difference to it: a kind need not be everywhere."""
    energies = search.energies(_rests(best.model))
    needed = tuple(
        placed
        for placed, energy in zip(best.model, energies, strict=True)
        if energy - best.selected >= search.least_gain
    )
    if not needed or len(needed) == len(best.model):
        return best
    lean = _best(search, [needed])
    most = best.selected + LEAST_SHARE * (best.selected - search.floor)
    return lean if lean is not None and lean.selected <= most else best


def _rests(model: Model) -> list[Model]:
    """The model without each of its effects."""
    return [tuple(other for other in model if other is not one) for one in model]


def _by_kind(guesses: Sequence[Guess], least: float, model: Model) -> list[Model]:
    """Kinds with their guesses at all joints: the best, then the best for their size.

    One late signal may be all that fast motions lack, though friction at all joints
    explains more of the slow ones.
    """
    known = {placed.key for placed in model}
    together: dict[str, tuple[float, list[PlacedEffect]]] = {}
    for guess in guesses:
        (placed,) = guess.model
        if guess.gain < least or placed.key in known:
            continue
        gain, every = together.get(placed.name, (0.0, []))
        together[placed.name] = gain + guess.gain, [*every, placed]
    kinds = [(gain, tuple(placed)) for gain, placed in together.values()]
    most = sorted(kinds, key=lambda kind: -kind[0])[:TRIED]
    rest = [kind for kind in kinds if kind not in most]
    lean = sorted(rest, key=lambda kind: -kind[0] / _values(kind[1]))[:LEAN]
    return [model for _, model in (*most, *lean)]


def _values(model: Model) -> int:
    return sum(len(placed.values) for placed in model)
