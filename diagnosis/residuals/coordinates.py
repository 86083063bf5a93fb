"""Converts the values of a model to scaled coordinates for a fit, and back."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import Parameter, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.replays import Model
from diagnosis.residuals.ties import group_of
from groundwalk.arrays import FloatArray

STEP = 0.02
"""Step of finite differences, in coordinates that are scaled to be of order one."""


class Coordinates:
    """Converts a model's values to scaled coordinates of order one, and back.

    Effects that are tied (see `PlacedEffect`) share their coordinates.

    Attributes:
      model: the model from which effects, places and ties are taken.
      parameters: the parameter of each coordinate, that of the first effect if tied.
      columns: indices of the coordinates of each effect's values.
    """

    def __init__(self, plant: Plant, model: Model) -> None:
        """Take effects, places and scales from a model, whatever its values are."""
        self.model = model
        self.parameters: list[Parameter] = []
        self.columns: list[list[int]] = []
        first: dict[tuple[str, str], list[int]] = {}
        for placed in model:
            group = group_of(placed)
            if group not in first or not placed.tied:
                own = effect(placed.name).parameters(plant, placed.place)
                start = len(self.parameters)
                first[group] = list(range(start, start + len(own)))
                self.parameters += own
            self.columns.append(first[group])

    def of(self, model: Model) -> FloatArray:
        """(p,) scaled coordinates of a model's values, clipped to their bounds."""
        x = np.zeros(len(self.parameters))
        for placed, own in zip(reversed(model), reversed(self.columns), strict=True):
            for i, value in zip(own, placed.values, strict=True):
                one = self.parameters[i]
                x[i] = self.scaled(i, min(max(value, one.low), one.high))
        return x

    def steps_from(self, x: FloatArray) -> FloatArray:
        """(p,) steps of finite differences from a point (p,).

        They go down where one up would leave the bounds.
        """
        return np.where(x + STEP <= self.bounds()[1], STEP, -STEP)

    def model_at(self, x: FloatArray) -> Model:
        """The model whose values have the (p,) scaled coordinates `x`."""
        values = self.values_at(x)
        return tuple(
            replace(old, values=tuple(values[i] for i in own))
            for old, own in zip(self.model, self.columns, strict=True)
        )

    def values_at(self, x: FloatArray) -> list[float]:
        """The p values, in SI units, at the (p,) scaled coordinates `x`."""
        return [_value(one, at) for one, at in zip(self.parameters, x, strict=True)]

    def columns_of(self, effects: Sequence[PlacedEffect]) -> list[int]:
        """Indices of the coordinates of some of the model's effects, increasing."""
        kept = {one.key for one in effects}
        every = zip(self.model, self.columns, strict=True)
        return sorted({i for placed, own in every if placed.key in kept for i in own})

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(p,) smallest and (p,) largest allowed scaled coordinates."""
        low = [self.scaled(i, p.low) for i, p in enumerate(self.parameters)]
        high = [self.scaled(i, p.high) for i, p in enumerate(self.parameters)]
        return np.array(low), np.array(high)

    def scaled(self, index: int, value: float) -> float:
        """The scaled coordinate of a value of the parameter with this index."""
        parameter = self.parameters[index]
        if parameter.logarithmic:
            return float(np.log(max(value, 1e-12)))
        return value / _scale(parameter)


def _scale(parameter: Parameter) -> float:
    """The size of a parameter that is 1 in scaled coordinates: its typical one."""
    size = abs(parameter.typical - parameter.neutral)
    if not np.isfinite(size) or size == 0:
        size = abs(parameter.typical) or parameter.high - parameter.low
    return size


def _value(parameter: Parameter, coordinate: float) -> float:
    """The value at a scaled coordinate, within the parameter's bounds."""
    size = (
        np.exp(coordinate) if parameter.logarithmic else coordinate * _scale(parameter)
    )
    return min(max(float(size), parameter.low), parameter.high)
