"""Fits the parameters of models by nonlinear least squares, several at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

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
    """A model with fitted values, its (N,) residual in units of noise, and Jacobian.

    The `jacobian` (N, p) is the derivative of the residual by scaled coordinates.
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
        each = enumerate(zip(self.parameters, values, strict=True))
        inside = [self.scaled(i, min(max(v, p.low), p.high)) for i, (p, v) in each]
        return np.array(inside)

    def model_at(self, x: FloatArray) -> Model:
        """The model whose values have the (p,) scaled coordinates `x`."""
        values = iter(map(_value, self.parameters, x))
        return tuple(
            replace(old, values=tuple(islice(values, len(old.values))))
            for old in self.model
        )

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


@dataclass(frozen=True, eq=False)
class Nudges:
    """Which values of a model are changed together in finite differences (nudged).

    Attributes:
      groups: indices of the values that are changed together; each group takes one
        simulation.
      rows: for each value (N,) flags of the entries of the residual that it changes.
    """

    groups: Sequence[Sequence[int]]
    rows: Sequence[BoolArray]


def fit_all(
    predictor: Predictor,
    starts: Sequence[Model],
    steps: int = MOST_STEPS,
    nudges_of: Callable[[Predictor, Model], Nudges] | None = None,
    followed: bool = False,
    jacobians: Sequence[FloatArray | None] | None = None,
    exactly: bool = False,
) -> list[FittedModel]:
    """Fit the values of several models, each from its own start, in this order.

    Args:
      predictor: predictor of the data to fit.
      starts: models with values to start from.
      steps: most steps of each fit.
      nudges_of: which values are changed together in differences; None: each by itself.
      followed: take differences at the start only, and update the Jacobian from the
        residuals of each step (Broyden), which needs no simulations. Good enough to
        compare models, but not for intervals.
      jacobians: (N, p) Jacobians at the starts from an earlier fit, None if unknown;
        only used with `followed`.
      exactly: correct each model's own integration error, which takes six times as long
        as a common correction.
    """

    def answer(questions: list[list[Model]]) -> list[FloatArray]:
        every = [model for question in questions for model in question]
        ends = np.cumsum([len(question) for question in questions])
        return np.split(predictor.residuals(every, exactly), ends[:-1])

    def task(start: Model, known: FloatArray | None) -> Callable[[Ask], FittedModel]:
        nudges = nudges_of(predictor, start) if nudges_of else None
        coordinates = Coordinates(predictor.plant, start)
        return lambda ask: _fit(
            _Course(coordinates, nudges, followed, ask), steps, known
        )

    every = zip(starts, jacobians or [None] * len(starts), strict=True)
    return lockstep([task(*one) for one in every], answer)


class _Course:
    """Residuals and Jacobians at the points that a fit visits, each computed once."""

    def __init__(
        self, coordinates: Coordinates, nudges: Nudges | None, followed: bool, ask: Ask
    ) -> None:
        self.coordinates, self._ask, self._followed = coordinates, ask, followed
        count = len(coordinates.parameters)
        alone = Nudges([[i] for i in range(count)], [np.array(True)] * count)
        self._nudges = nudges or alone
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
                model = self.coordinates.model_at(x)
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
        groups, rows = self._nudges.groups, self._nudges.rows
        far = np.where(x + STEP <= self._high, STEP, -STEP)
        points = [x, *(x + far * np.isin(np.arange(len(x)), own) for own in groups)]
        seen = self._ask([self.coordinates.model_at(point) for point in points])
        found = np.zeros((seen.shape[1], len(x)))
        for own, other in zip(groups, seen[1:], strict=True):
            for i in own:
                found[:, i] = np.where(rows[i], (other - seen[0]) / far[i], 0.0)
        self._residuals[x.tobytes()] = seen[0]
        self._jacobians[x.tobytes()] = found

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


def _fit(course: _Course, steps: int, jacobian: FloatArray | None) -> FittedModel:
    """Fit one model with SciPy's trust-region least squares; arguments of `fit_all`."""
    from scipy.optimize import least_squares

    coordinates = course.coordinates
    low, high = coordinates.bounds()
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


ON_BOUND = 1e-3
"""Distance from a bound, in scaled coordinates, within which a value is on it."""

SECONDARY = ("start", "duration", "side", "rest")
"""Names of parameters that do not say how large an effect is."""


def ran_into_bound(fit: FittedModel, placed: PlacedEffect) -> bool:
    """Whether a value that says how large one of a fit's effects is lies on a bound.

    The bound of no effect does not count, nor does that of all there is (such as a
    motor that lost all of its torque).
    """
    low, high = fit.coordinates.bounds()
    x, first = fit.coordinates.of(fit.model), 0
    for one in fit.model:
        for i in range(first, first + len(one.values)):
            parameter = fit.coordinates.parameters[i]
            ends = [(low[i], parameter.low)]
            if not parameter.full:
                ends.append((high[i], parameter.high))
            if (
                one is placed
                and parameter.name not in SECONDARY
                and any(
                    abs(x[i] - at) < ON_BOUND and value != parameter.neutral
                    for at, value in ends
                )
            ):
                return True
        first += len(one.values)
    return False
