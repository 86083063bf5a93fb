"""Proposes kinds of effects that many joints may lack, each with values to start from.

A kind is proposed with values that all joints share, with one for each kind of motor,
and with one for each joint; or the values of a kind that a model has are untied.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from diagnosis.effects.library import effect, grown_from
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.ties import Level, labels, motors, number_of_values, tied
from diagnosis.search.result import Judged
from diagnosis.search.screening import Guess, Screen

TRIED = 3
"""Number of models that are fitted in each round since they are estimated to gain most,
over all joints together."""

LEAN = 3
"""Number of further models that are fitted in each round since they are estimated to
gain most for each fitted value."""


@dataclass(frozen=True)
class _Option:
    """A model to try, the gain [nats] by a linear estimate, and its further values."""

    model: Model
    gain: float
    values: int


def kinds_to_add(
    fit: Predictor, screen: Screen, best: Judged, without: Collection[str] = ()
) -> list[list[Model]]:
    """Models to try in turn: first those with shared values, then those without.

    Joints with the same motor are alike until the recordings show that they are not, so
    that further values are tried where none that all joints share helps any more. Of
    each sort come first the models that are estimated to gain most, then those that
    gain most for each value: a single delay may explain all fast motions, although
    friction at all joints gains more in the slow ones. At last come more general forms
    of the kinds that the model has, except for kinds `without`.
    """
    plant = fit.plant
    added = list(_added(plant, screen, best))
    most = len(set(motors(plant).values()))
    shared = [one for one in added if one.values <= most]
    apart = [one for one in added if one.values > most]
    apart += _untied(plant, screen, best)
    return [_likely(shared), [*_likely(apart), *_grown(fit, best.model, without)]]


def _likely(options: Sequence[_Option]) -> list[Model]:
    """The models that are estimated to gain most, and most for each value."""
    most = sorted(options, key=lambda one: -one.gain)[:TRIED]
    others = [one for one in options if one not in most]
    lean = sorted(others, key=lambda one: -one.gain / one.values)[:LEAN]
    return [one.model for one in (*most, *lean)]


def _added(plant: Plant, screen: Screen, best: Judged) -> Iterator[_Option]:
    """The model with each kind of effect at the joints that lack it.

    Shared or not, if none has it.
    """
    left = best.fit.residual, best.fit.jacobian
    known = {placed.name for placed in best.model}
    kinds = dict[str, list[Guess]]()
    for guess in screen.singles(*left):
        if guess.model[0].key not in best.keys:
            kinds.setdefault(guess.model[0].name, []).append(guess)
    for name, guesses in kinds.items():
        each = tuple(guess.model[0] for guess in guesses)
        gain = sum(guess.gain for guess in guesses)
        yield _Option((*best.model, *each), gain, number_of_values(each))
        if effect(name).of_motor and len(each) > 1 and name not in known:
            yield from _shared(plant, screen, best, name)


def _shared(plant: Plant, screen: Screen, best: Judged, name: str) -> Iterator[_Option]:
    """The model with a kind of effect at all joints, with values that they share."""
    seen = set[frozenset[PlacedEffect]]()
    levels: tuple[Level, ...] = ("all", "motor")
    for level in levels:
        joints = dict[str, list[str]]()
        for joint, label in labels(plant, level).items():
            joints.setdefault(label, []).append(f"{name}@{joint}")
        found = [
            screen.shared(best.fit.residual, best.fit.jacobian, keys)
            for keys in joints.values()
        ]
        guesses = [guess for guess in found if guess]
        more = tied(plant, [one for guess in guesses for one in guess.model], level)
        if more and frozenset(more) not in seen:
            seen.add(frozenset(more))
            gain = sum(guess.gain for guess in guesses)
            yield _Option((*best.model, *more), gain, number_of_values(more))


def _grown(fit: Predictor, model: Model, without: Collection[str]) -> Iterator[Model]:
    """The model with more general forms of a kind of effect at all of its joints.

    Each form has values of its own at each joint, or values that joints share: where a
    simple form needs another value at each joint, a general one may not, as of dry
    friction that grows with the load.
    """
    for name in sorted({placed.name for placed in model}):
        rest = tuple(placed for placed in model if placed.name != name)
        grown = [grown_from(placed) for placed in model if placed.name == name]
        for forms in zip(*grown, strict=True):
            kind = effect(forms[0].name)
            places = {one.place for one in forms}
            if kind.name not in without and places <= {
                *kind.places(fit.plant, fit.traces)
            }:
                levels: tuple[Level, ...] = ("all", "motor", "each")
                every = [tied(fit.plant, forms, level) for level in levels]
                yield from ((*rest, *own) for own in dict.fromkeys(every))


def _untied(plant: Plant, screen: Screen, best: Judged) -> Iterator[_Option]:
    """The model with the values of each kind of effect shared less widely."""
    levels: tuple[Level, ...] = ("motor", "each")
    for name in sorted({placed.name for placed in best.model if placed.tied}):
        own = [placed for placed in best.model if placed.name == name]
        rest = tuple(placed for placed in best.model if placed.name != name)
        left = best.fit.residual, best.fit.jacobian
        gain = screen.freed(*left, [placed.key for placed in own])
        for level in levels:
            freed = tied(plant, own, level)
            more = number_of_values(freed) - number_of_values(tuple(own))
            if more > 0:
                yield _Option((*rest, *freed), gain, more)
