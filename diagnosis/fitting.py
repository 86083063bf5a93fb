"""Values of effects by nonlinear least squares, several structures at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effect import Parameter, Placed
from diagnosis.library import effect
from diagnosis.lockstep import lockstep
from diagnosis.plant import Plant
from diagnosis.predictor import Model, Predictor
from groundwalk.arrays import FloatArray

STEP = 0.02
"""Of the differences, as a part of a parameter's scale."""

MOST_STEPS = 8
TOLERANCE = 1e-4

Ask = Callable[[list[Model]], FloatArray]


@dataclass(frozen=True, eq=False)
class Fit:
    """A model whose values were fitted.

    Attributes:
      model: with the values found.
      residual: (N,) at the model, in units of noise.
      jacobian: (N, p) of the residual to the values' scaled coordinates.
      energy: half the sum of squared residuals: minus the log-likelihood.
    """

    model: Model
    residual: FloatArray
    jacobian: FloatArray
    coordinates: "Coordinates"

    @property
    def energy(self) -> float:
        """Half the sum of squared residuals: minus the log-likelihood."""
        return 0.5 * float(self.residual @ self.residual)


class Coordinates:
    """The values of a model's effects as one vector of numbers of order one."""

    def __init__(self, plant: Plant, model: Model) -> None:
        """Take structure and scales from a model and its plant."""
        self.model = model
        self.parameters: list[Parameter] = [
            parameter
            for placed in model
            for parameter in effect(placed.effect).parameters(plant, placed.place)
        ]

    def of(self, model: Model) -> FloatArray:
        """(p,) the vector of a model."""
        values = [value for placed in model for value in placed.values]
        return np.array(
            [
                self.scaled(i, min(max(v, p.low), p.high))
                for i, (p, v) in enumerate(zip(self.parameters, values, strict=True))
            ]
        )

    def model_at(self, x: FloatArray) -> Model:
        """The model of a vector."""
        values = [
            self._value(parameter, coordinate)
            for parameter, coordinate in zip(self.parameters, x, strict=True)
        ]
        placed, first = [], 0
        for old in self.model:
            last = first + len(old.values)
            placed.append(Placed(old.effect, old.place, tuple(values[first:last])))
            first = last
        return tuple(placed)

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(p,) least and largest coordinates."""
        low = [self.scaled(i, p.low) for i, p in enumerate(self.parameters)]
        high = [self.scaled(i, p.high) for i, p in enumerate(self.parameters)]
        return np.array(low), np.array(high)

    @staticmethod
    def _value(parameter: Parameter, coordinate: float) -> float:
        if parameter.logarithmic:
            value = float(np.exp(coordinate))
        else:
            value = float(coordinate * _scale(parameter))
        return min(max(value, parameter.low), parameter.high)

    def scaled(self, index: int, value: float) -> float:
        """The coordinate of a value."""
        parameter = self.parameters[index]
        if parameter.logarithmic:
            return float(np.log(max(value, 1e-12)))
        return value / _scale(parameter)


def _scale(parameter: Parameter) -> float:
    size = abs(parameter.typical - parameter.neutral)
    if not np.isfinite(size) or size == 0:
        size = abs(parameter.typical) or parameter.high - parameter.low
    return size


def fit_all(
    predictor: Predictor, starts: Sequence[Model], steps: int = MOST_STEPS
) -> list[Fit]:
    """Fit the values of several models, each from its own start."""

    def answer(questions: list[list[Model]]) -> list[FloatArray]:
        every = [model for question in questions for model in question]
        residuals = predictor.residuals(every)
        ends = np.cumsum([len(question) for question in questions])
        return np.split(residuals, ends[:-1])

    tasks = [_task(predictor.plant, start, steps) for start in starts]
    return lockstep(tasks, answer) if tasks else []


def _task(plant: Plant, start: Model, steps: int) -> Callable[[Ask], Fit]:
    coordinates = Coordinates(plant, start)

    def run(ask: Ask) -> Fit:
        return _fit(coordinates, start, steps, ask)

    return run


def _fit(coordinates: Coordinates, start: Model, steps: int, ask: Ask) -> Fit:
    from scipy.optimize import least_squares

    low, high = coordinates.bounds()
    known: dict[bytes, tuple[FloatArray, FloatArray]] = {}

    def both(x: FloatArray) -> tuple[FloatArray, FloatArray]:
        key = x.tobytes()
        if key not in known:
            nudges = np.where(x + STEP <= high, STEP, -STEP)
            nudged = [
                x + nudge * row
                for nudge, row in zip(nudges, np.eye(len(x)), strict=True)
            ]
            rows = ask([coordinates.model_at(each) for each in (x, *nudged)])
            known[key] = rows[0], ((rows[1:] - rows[0]) / nudges[:, None]).T
        return known[key]

    x = np.clip(coordinates.of(start), low + 1e-9, high - 1e-9)
    found = least_squares(
        lambda x: both(x)[0],
        x,
        jac=lambda x: both(x)[1],
        bounds=(low, high),
        max_nfev=steps,
        ftol=TOLERANCE,
        xtol=1e-4,
    )
    residual, jacobian = both(found.x)
    return Fit(coordinates.model_at(found.x), residual, jacobian, coordinates)
