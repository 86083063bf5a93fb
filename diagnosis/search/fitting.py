"""Fits the parameters of models by nonlinear least squares, several at a time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.batched_tasks import lockstep
from diagnosis.search.nudges import Nudges, nudges_of
from groundwalk.arrays import FloatArray

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
    coordinates: Coordinates

    @property
    def energy(self) -> float:
        """Half the sum of squared residuals [nats]: minus the log-likelihood."""
        return 0.5 * float(self.residual @ self.residual)

    def jacobian_of(self, effects: Model) -> FloatArray:
        """(N, p) the columns of the Jacobian that belong to some of the effects."""
        return self.jacobian[:, self.coordinates.columns_of(effects)]


def fit_all(
    predictor: Predictor,
    starts: Sequence[Model],
    steps: int = MOST_STEPS,
    followed: bool = False,
    jacobians: Sequence[FloatArray | None] | None = None,
    exactly: bool = False,
) -> list[FittedModel]:
    """Fit the values of several models, each from its own start, in this order.

    Args:
      predictor: predictor of the data to fit.
      starts: models with values to start from.
      steps: most steps of each fit.
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
        coordinates = Coordinates(predictor.plant, start)
        nudges = nudges_of(predictor, coordinates)
        course = partial(_Course, coordinates, nudges, followed)
        return lambda ask: _fit(course(ask), steps, known)

    every = zip(starts, jacobians or [None] * len(starts), strict=True)
    return lockstep([task(*one) for one in every], answer)


class _Course:
    """Residuals and Jacobians at the points that a fit visits, each computed once."""

    def __init__(
        self, coordinates: Coordinates, nudges: Nudges, followed: bool, ask: Ask
    ) -> None:
        self.coordinates, self._ask, self._followed = coordinates, ask, followed
        self._nudges = nudges
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
        """(N, p) Jacobian at a point (p,), whose residual must be known.

        It is asked for at points from which the fit goes on. Those of others are not
        needed any more, and take much memory.
        """
        key = x.tobytes()
        own = self._jacobians[key] if key in self._jacobians else self._updated(x)
        self._jacobians, self._last = {key: own}, x.copy()
        return own

    def _differences(self, x: FloatArray) -> None:
        """Compute residual and Jacobian at a point (p,) by finite differences."""
        groups, rows = self._nudges.groups, self._nudges.rows
        far = self.coordinates.steps_from(x)
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

SECONDARY = ("start", "duration", "side", "rest", "phase")
"""Names of parameters that do not say how large an effect is."""


def ran_into_bound(fit: FittedModel, placed: PlacedEffect) -> bool:
    """Whether a value that says how large one of a fit's effects is lies on a bound.

    The bound of no effect does not count, nor does that of all there is (such as a
    motor that lost all of its torque).
    """
    low, high = fit.coordinates.bounds()
    x = fit.coordinates.of(fit.model)
    for i in fit.coordinates.columns_of([placed]):
        parameter = fit.coordinates.parameters[i]
        ends = [(low[i], parameter.low)]
        if not parameter.full:
            ends.append((high[i], parameter.high))
        if parameter.name not in SECONDARY and any(
            abs(x[i] - at) < ON_BOUND and value != parameter.neutral
            for at, value in ends
        ):
            return True
    return False
