"""Fits the parameters of models by nonlinear least squares, several at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import Parameter, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.batched_tasks import lockstep
from groundwalk.arrays import BoolArray, FloatArray

STEP = 0.02
"""Step of finite differences, in coordinates that are scaled to be of order one."""

HOLD = 1e-3
"""Weight of a penalty on the distance from the start values, so that values that the
data do not determine neither drift nor shorten the steps."""

MOST_STEPS = 8
"""Most steps of a fit; most fits converge in fewer."""

TOLERANCE = 1e-4
"""Relative change of the sum of squared residuals at which a fit ends."""

Ask = Callable[[list[Model]], FloatArray]
"""A function that computes the (n, N) residuals of n models."""


@dataclass(frozen=True, eq=False)
class FittedModel:
    """A model with fitted values.

    Attributes:
      model: the effects with the values found.
      residual: (N,) residual of the model, in units of noise.
      jacobian: (N, p) derivative of the residual by the scaled coordinates.
      coordinates: conversion between the p values and coordinates of order one.
    """

    model: Model
    residual: FloatArray
    jacobian: FloatArray
    coordinates: "Coordinates"

    @property
    def energy(self) -> float:
        """Half the sum of squared residuals [nats]: minus the log-likelihood."""
        return 0.5 * float(self.residual @ self.residual)

    def jacobian_of(self, effects: Model) -> FloatArray:
        """(N, p) the columns of the Jacobian that belong to some of the effects."""
        kept = [
            any(placed is one for one in effects)
            for placed in self.model
            for _ in placed.values
        ]
        return self.jacobian[:, kept]


class Coordinates:
    """Converts a model's values to scaled coordinates of order one, and back."""

    def __init__(self, plant: Plant, model: Model) -> None:
        """Take effects, places and scales from a model, whatever its values are."""
        self.model = model
        self.parameters: list[Parameter] = [
            parameter
            for placed in model
            for parameter in effect(placed.name).parameters(plant, placed.place)
        ]

    def of(self, model: Model) -> FloatArray:
        """(p,) scaled coordinates of a model's p values, clipped to their bounds."""
        values = [value for placed in model for value in placed.values]
        return np.array(
            [
                self.scaled(i, min(max(v, p.low), p.high))
                for i, (p, v) in enumerate(zip(self.parameters, values, strict=True))
            ]
        )

    def model_at(self, x: FloatArray) -> Model:
        """The model whose values have the (p,) scaled coordinates `x`."""
        values = [
            self._value(parameter, coordinate)
            for parameter, coordinate in zip(self.parameters, x, strict=True)
        ]
        placed, first = [], 0
        for old in self.model:
            last = first + len(old.values)
            placed.append(PlacedEffect(old.name, old.place, tuple(values[first:last])))
            first = last
        return tuple(placed)

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """(p,) smallest and (p,) largest allowed scaled coordinates."""
        low = [self.scaled(i, p.low) for i, p in enumerate(self.parameters)]
        high = [self.scaled(i, p.high) for i, p in enumerate(self.parameters)]
        return np.array(low), np.array(high)

    @staticmethod
    def _value(parameter: Parameter, coordinate: float) -> float:
        """The value at a scaled coordinate, within the parameter's bounds."""
        if parameter.logarithmic:
            value = float(np.exp(coordinate))
        else:
            value = float(coordinate * _scale(parameter))
        return min(max(value, parameter.low), parameter.high)

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


@dataclass(frozen=True, eq=False)
class Nudges:
    """Which values of a model are changed together in finite differences (nudged).

    Attributes:
      groups: indices of the values that are changed together; each group takes one
        simulation.
      rows: for each value (N,) flags of the entries of the residual that it changes;
        None if each value changes all entries.
    """

    groups: Sequence[Sequence[int]]
    rows: Sequence[BoolArray] | None = None

    @classmethod
    def apart(cls, predictor: Predictor, model: Model) -> "Nudges":
        """Nudges that change each value of a model by itself."""
        count = sum(len(placed.values) for placed in model)
        return cls([[i] for i in range(count)])

    def steps(self, x: FloatArray, high: FloatArray) -> FloatArray:
        """(p,) steps of scaled coordinates, negative near their upper bounds `high`."""
        return np.where(x + STEP <= high, STEP, -STEP)

    def nudged(self, x: FloatArray, steps: FloatArray) -> list[FloatArray]:
        """For each group the (p,) coordinates `x` with the group's `steps` added."""
        return [x + steps * np.isin(np.arange(len(x)), own) for own in self.groups]

    def jacobian(self, seen: FloatArray, steps: FloatArray) -> FloatArray:
        """(N, p) Jacobian by finite differences.

        Args:
          seen: (1 + groups, N) residuals at a point, and with each group changed.
          steps: (p,) changes of the scaled coordinates.
        """
        found = np.zeros((seen.shape[1], len(steps)))
        for own, other in zip(self.groups, seen[1:], strict=True):
            for i in own:
                slope = (other - seen[0]) / steps[i]
                shown = True if self.rows is None else self.rows[i]
                found[:, i] = np.where(shown, slope, 0.0)
        return found


def fit_all(
    predictor: Predictor,
    starts: Sequence[Model],
    steps: int = MOST_STEPS,
    nudges_of: Callable[[Predictor, Model], Nudges] = Nudges.apart,
    followed: bool = False,
    jacobians: Sequence[FloatArray | None] | None = None,
    exactly: bool = False,
) -> list[FittedModel]:
    """Fit the values of several models, each from its own start.

    Args:
      predictor: predictor of the data to fit.
      starts: models with values to start from.
      steps: most steps of each fit.
      nudges_of: says which values of a model are changed together in differences.
      followed: take differences at the start only, and update the Jacobian from the
        residuals of each step (Broyden), which needs no simulations. Good enough to
        compare models, but not for intervals.
      jacobians: (N, p) Jacobians at the starts from an earlier fit, None if unknown;
        only used with `followed`.
      exactly: correct each model's own integration error, which takes six times as
        long as a common correction.

    Returns:
      The fitted models, in the order of their starts.
    """

    def answer(questions: list[list[Model]]) -> list[FloatArray]:
        every = [model for question in questions for model in question]
        ends = np.cumsum([len(question) for question in questions])
        return np.split(predictor.residuals(every, exactly), ends[:-1])

    tasks = [
        partial(
            _fit,
            Coordinates(predictor.plant, start),
            nudges_of(predictor, start),
            steps,
            followed,
            jacobian,
        )
        for start, jacobian in zip(
            starts, jacobians or [None] * len(starts), strict=True
        )
    ]
    return lockstep(tasks, answer) if tasks else []


class _Course:
    """Residuals and Jacobians at the points that a fit visits, each computed once."""

    def __init__(
        self, coordinates: Coordinates, nudges: Nudges, followed: bool, ask: Ask
    ) -> None:
        self._coordinates, self._nudges, self._ask = coordinates, nudges, ask
        self._followed = followed
        self._high = coordinates.bounds()[1]
        self._residuals: dict[bytes, FloatArray] = {}
        self._jacobians: dict[bytes, FloatArray] = {}
        self._last: FloatArray | None = None
        """(p,) point, in scaled coordinates, at which a Jacobian was computed last."""

    def begin(self, x: FloatArray, jacobian: FloatArray) -> None:
        """Start from a known Jacobian (N, p) at a point (p,)."""
        self._jacobians[x.tobytes()] = jacobian

    def residual(self, x: FloatArray) -> FloatArray:
        """(N,) residual at a point (p,)."""
        if x.tobytes() not in self._residuals:
            if self._followed and self._jacobians:
                model = self._coordinates.model_at(x)
                self._residuals[x.tobytes()] = self._ask([model])[0]
            else:  # the Jacobian will be asked for next
                self._differences(x)
        return self._residuals[x.tobytes()]

    def jacobian(self, x: FloatArray) -> FloatArray:
        """(N, p) Jacobian at a point (p,), whose residual must be known."""
        if x.tobytes() not in self._jacobians:
            self._jacobians[x.tobytes()] = self._updated(x)
        self._last = x.copy()
        return self._jacobians[x.tobytes()]

    def _differences(self, x: FloatArray) -> None:
        """Compute residual and Jacobian at a point (p,) by finite differences."""
        far = self._nudges.steps(x, self._high)
        points = (x, *self._nudges.nudged(x, far))
        seen = self._ask([self._coordinates.model_at(point) for point in points])
        self._residuals[x.tobytes()] = seen[0]
        self._jacobians[x.tobytes()] = self._nudges.jacobian(seen, far)

    def _updated(self, x: FloatArray) -> FloatArray:
        """(N, p) Jacobian at a point, updated from the latest one without simulation.

        It is the nearest matrix that maps the step to the change of the residual:
        Broyden 1965, A class of methods for solving nonlinear simultaneous equations.
        """
        assert self._last is not None
        step, before = x - self._last, self._jacobians[self._last.tobytes()]
        changed = self._residuals[x.tobytes()] - self._residuals[self._last.tobytes()]
        missed = changed - before @ step
        return np.asarray(before + np.outer(missed, step / (step @ step)))


def _fit(
    coordinates: Coordinates,
    nudges: Nudges,
    steps: int,
    followed: bool,
    jacobian: FloatArray | None,
    ask: Ask,
) -> FittedModel:
    """Fit one model with SciPy's trust-region least squares; arguments of `fit_all`."""
    from scipy.optimize import least_squares

    low, high = coordinates.bounds()
    course = _Course(coordinates, nudges, followed, ask)
    inside = [1e-9 * np.maximum(1.0, np.abs(bound)) for bound in (low, high)]
    x = np.clip(coordinates.of(coordinates.model), low + inside[0], high - inside[1])
    if jacobian is not None:
        course.begin(x, jacobian)
    held = HOLD * np.eye(len(x))
    found = least_squares(
        lambda now: np.concatenate([course.residual(now), held @ (now - x)]),
        x,
        jac=lambda now: np.vstack([course.jacobian(now), held]),
        bounds=(low, high),
        max_nfev=steps,
        ftol=TOLERANCE,
        xtol=1e-4,
    )
    model = coordinates.model_at(found.x)
    at_end = course.residual(found.x), course.jacobian(found.x)
    return FittedModel(model, *at_end, coordinates)
