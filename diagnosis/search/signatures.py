"""Signatures: the changes of a simulation that each effect at each place causes.

Servos are stiff, so that a change at one joint hardly moves the others. An effect is
therefore tried at all joints in one simulation, and the change in each joint's own
channels is its signature there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import Interval, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import Coordinates
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray, IntArray


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

    Args:
      predictor: simulates the recordings.
      base: the model to which the effects are added, one or one kind at a time.
      usage: range, speed and torque of the joints, which set the sizes that are tried.
      intervals: start and duration [s] of possible pushes.
      names: names of the effects to try; all if empty.
    """
    trials = _trials(predictor, usage, intervals, names or tuple(all_effects()))
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
            first = Coordinates(predictor.plant, (placed,)).parameters[0]
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
    for name in names:
        kind = effect(name)
        places = kind.places(predictor.plant, predictor.traces)
        if kind.at_tips:
            places = tuple(p for p in places if p in tips(predictor.plant)) or places
        options = {
            place: kind.first_tries(predictor.plant, place, usage, intervals)
            for place in places
        }
        if not any(options.values()):
            continue
        if kind.place_kind == "joint" and kind.joint_by_joint:
            for level in range(max(map(len, options.values()))):
                model = tuple(
                    PlacedEffect(name, place, values[level])
                    for place, values in options.items()
                )
                trials.append((model, True))
        else:
            trials += [
                ((PlacedEffect(name, place, each),), False)
                for place, values in options.items()
                for each in values
            ]
    return trials


def tips(plant: Plant) -> frozenset[str]:
    """Names of the bodies that carry no other body, such as hands and feet."""
    model = plant.model
    carrying = {int(parent) for parent in model.body_parentid[1:]}
    every = range(1, model.nbody)
    return frozenset(model.body(i).name for i in every if i not in carrying)
