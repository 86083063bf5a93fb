"""Signatures: how each effect at each place changes the residual.

Servos are stiff, so that a change at one joint hardly moves the others: an effect is
tried at all joints in one simulation, and the change in each joint's own channels is
its signature there. Joints that meet a limit may collapse and take others along, so
that limits are tried one by one, if the robot has few joints. And where recordings of
the healthy robot show errors of all joints together, a residual is whitened with these,
so that a change at one joint shows at others: there all is tried joint by joint.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import Interval, PlacedEffect, Values
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray, IntArray

FEW_JOINTS = 6
"""For robots with at most this many joints more is tried: limits joint by joint, and
each kind of effect at its best guessed place."""


@dataclass(frozen=True, eq=False)
class Signature:
    """The change of the residual that an effect of a tried size causes at a place.

    Attributes:
      placed: the effect with the values that were tried.
      change: (rows,) change of the residual, in units of noise.
      rows: (rows,) indices into the residual: all, or those of the joint's channels.
      two_sided: whether the effect may also have the opposite sign.
    """

    placed: PlacedEffect
    change: FloatArray
    rows: IntArray
    two_sided: bool


def signatures(
    predictor: Predictor,
    base: Model,
    usage: Usage,
    intervals: Sequence[Interval] = (),
    names: Sequence[str] = (),
) -> list[Signature]:
    """Simulate effects at all their places, to see how each changes the residual.

    The effects `names`, all if empty, are added to the model `base`, one or one kind at
    a time. The `usage` of the joints sets the sizes that are tried; `intervals` are
    those in which effects may act that do not last.
    """
    trials = _trials(predictor, usage, intervals, names or tuple(all_effects()))
    return _simulated(predictor, base, trials)


def signatures_apart(
    predictor: Predictor, every: Sequence[PlacedEffect]
) -> list[Signature]:
    """Simulate given effects one by one, with what each changes at other joints.

    That is little, but most of what is left where usual errors of a model can make
    nearly all that an effect changes at its own joint. Limits and stops, with which no
    others are compared, are simulated as in `signatures_of`. The order is another one.
    """
    limits = [one for one in every if effect(one.name).threshold]
    others = [one for one in every if not effect(one.name).threshold]
    trials = [*_together(limits), *(((one,), False) for one in others)]
    return _simulated(predictor, (), trials)


def signatures_of(
    predictor: Predictor, every: Sequence[PlacedEffect]
) -> list[Signature]:
    """Simulate given effects, as fast as is possible: kinds at all joints together.

    That holds for limits and stops, too, which must be so mild that no joint collapses.
    The signatures are in another order.
    """
    return _simulated(predictor, (), _together(every))


def _together(every: Sequence[PlacedEffect]) -> list[tuple[Model, bool]]:
    """Effects in models, those of one kind at all joints in the same one."""
    groups: dict[tuple[str, int], list[PlacedEffect]] = {}
    seen: dict[str, int] = {}
    for placed in every:
        number = seen[placed.key] = seen.get(placed.key, -1) + 1
        groups.setdefault((placed.name, number), []).append(placed)
    trials: list[tuple[Model, bool]] = []
    for (name, _), own in groups.items():
        kind = effect(name)
        if kind.place_kind == "joint" and kind.joint_by_joint and not kind.timed:
            trials.append((tuple(own), True))
        else:
            trials += [((placed,), False) for placed in own]
    return trials


def _simulated(
    predictor: Predictor, base: Model, trials: Sequence[tuple[Model, bool]]
) -> list[Signature]:
    """The signatures of effects that are added to a model, see `_trials`."""
    models = [base, *(base + added for added, _ in trials)]
    residuals = predictor.residuals(models)
    found = []
    for row, (added, joint_wise) in enumerate(trials, start=1):
        change = residuals[row] - residuals[0]
        for placed in added:
            rows = np.arange(len(change))
            if joint_wise:
                own = predictor.channels.of_joint(placed.place)
                rows = np.flatnonzero(np.isin(predictor.channel, own))
            # whether its first value may be below and above the neutral one
            kind = effect(placed.name)
            first = kind.parameters(predictor.plant, placed.place)[0]
            two_sided = first.low < first.neutral < first.high
            found.append(Signature(placed, change[rows], rows, two_sided))
    return found


def _trials(
    predictor: Predictor,
    usage: Usage,
    intervals: Sequence[Interval],
    names: Sequence[str],
) -> list[tuple[Model, bool]]:
    """Effects to simulate together, and whether these are one kind at all joints."""
    trials: list[tuple[Model, bool]] = []
    mixed = predictor.has_reference and predictor.plant.base == "fixed"
    for name in names:
        kind = effect(name)
        places = kind.places(predictor.plant, predictor.traces)
        if kind.at_tips:
            places = tuple(p for p in places if p in tips(predictor.plant)) or places
        options = {
            place: kind.first_tries(predictor.plant, place, usage) for place in places
        }
        if kind.timed:
            trials += _timed(name, options, intervals)
            continue
        if not any(options.values()):
            continue
        apart = mixed or (kind.threshold and len(places) <= FEW_JOINTS)
        if kind.place_kind == "joint" and kind.joint_by_joint and not apart:
            for level in range(max(map(len, options.values()))):
                model = tuple(
                    PlacedEffect(name, place, values[level])
                    for place, values in options.items()
                    if level < len(values)
                )
                trials.append((model, True))
        else:
            trials += [
                ((PlacedEffect(name, place, each),), False)
                for place, values in options.items()
                for each in values
            ]
    return trials


def _timed(
    name: str, options: Mapping[str, Sequence[Values]], intervals: Sequence[Interval]
) -> list[tuple[Model, bool]]:
    """An effect at its places, with the values to try there, in each interval."""
    if not effect(name).lasting:
        intervals = [one for one in intervals if one.start_s >= 0]
    every = [
        PlacedEffect(name, place, (*values[:-2], start_s, duration_s), recording)
        for place, tries in options.items()
        for start_s, duration_s, recording in intervals
        for values in tries
    ]
    return [((placed,), False) for placed in every]


def tips(plant: Plant) -> frozenset[str]:
    """Names of the bodies that carry no other body, such as hands and feet."""
    model = plant.model
    carrying = {int(parent) for parent in model.body_parentid[1:]}
    every = range(1, model.nbody)
    return frozenset(model.body(i).name for i in every if i not in carrying)
