"""The errors that robot models usually have, and how far values are from nominal."""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.library import all_effects, effect
from diagnosis.effects.parts import Parameter, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace

USUAL = 3.0
"""Largest small error, in usual standard deviations: what is larger is not usual."""


def usual_errors(plant: Plant, traces: Sequence[Trace]) -> list[PlacedEffect]:
    """Effects of the size of a model's usual errors, each component by itself."""
    found = []
    for name, kind in all_effects().items():
        for place in kind.places(plant, traces):
            size = kind.spread(plant, place)
            parameters = kind.parameters(plant, place)
            for i in range(kind.components if size else 0):
                values = [one.neutral for one in parameters]
                values[i] = value_at(parameters[i], size)
                found.append(PlacedEffect(name, place, tuple(values)))
    return found


def is_usual(plant: Plant, placed: PlacedEffect) -> bool:
    """Whether an effect is as small as usual errors of models are."""
    kind = effect(placed.name)
    most = USUAL * kind.spread(plant, placed.place)
    every = kind.parameters(plant, placed.place)[: kind.components]
    values = zip(every, placed.values, strict=False)
    return most > 0 and all(abs(far_of(one, value)) <= most for one, value in values)


def acting(plant: Plant, model: Sequence[PlacedEffect]) -> tuple[PlacedEffect, ...]:
    """The effects of a model that change anything: whose values are not all neutral."""
    return tuple(
        one
        for one in model
        if any(
            value != parameter.neutral
            for parameter, value in zip(
                effect(one.name).parameters(plant, one.place), one.values, strict=True
            )
        )
    )


def component_of(every: Sequence[Parameter], unit: PlacedEffect) -> int:
    """Index of the value that a unit changes."""
    return next(
        i
        for i, (one, value) in enumerate(zip(every, unit.values, strict=True))
        if value != one.neutral
    )


def far_of(parameter: Parameter, value: float) -> float:
    """How far a value is from the neutral one, as a logarithm where it is a factor."""
    if parameter.logarithmic:
        return float(np.log(max(value, 1e-12) / parameter.neutral))
    return value - parameter.neutral


def value_at(parameter: Parameter, far: float) -> float:
    """The value so far from the neutral one."""
    if parameter.logarithmic:
        return float(parameter.neutral * np.exp(far))
    return parameter.neutral + far


def is_possible(placed: PlacedEffect, every: Sequence[Parameter]) -> bool:
    """Whether an effect's values are within its bounds."""
    values = zip(every, placed.values, strict=True)
    return all(one.low <= value <= one.high for one, value in values)
