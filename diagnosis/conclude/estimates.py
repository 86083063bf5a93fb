"""Intervals for fitted values."""

from collections.abc import Mapping

import numpy as np

from diagnosis.conclude.block_errors import (
    PRIOR_SPREAD,
    block_variance,
    information,
)
from diagnosis.conclude.recordings_alone import errors_between_recordings, said_alone
from diagnosis.effects.library import effect
from diagnosis.residuals.coordinates import STEP, Coordinates
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import FittedModel
from diagnosis.verdict import Estimate, ValueRange
from groundwalk.arrays import BoolArray, FloatArray

Z_80 = 1.2815515655446004
"""Half width of an 80 % interval of the normal distribution, in standard deviations."""


def estimates(predictor: Predictor, fit: FittedModel) -> list[Mapping[str, Estimate]]:
    """For each effect its values with 80 % intervals and units, by parameter name.

    Where joints share a value, the interval is that of the value at one of them: it is
    as wide as joints differ. The `fit` to the predictor's data has a Jacobian by finite
    differences.
    """
    spreads = largest_errors, spread_of_joints, spread_of_starts, spread_of_softness
    deviation = np.linalg.norm([one(predictor, fit) for one in spreads], axis=0)
    x, coordinates = fit.coordinates.of(fit.model), fit.coordinates
    ranges = value_ranges(coordinates, x, deviation)
    alone = {
        name: value_ranges(coordinates, own, errors)
        for name, (own, errors) in said_alone(predictor, fit).items()
    }
    ends = [coordinates.values_at(one) for one in ends_of_starts(predictor, fit)]
    ended = np.reshape(ends, (-1, len(x)))
    every: list[Mapping[str, Estimate]] = []
    for placed, columns in zip(fit.model, coordinates.columns, strict=True):
        own = {}
        for value, i in zip(placed.values, columns, strict=True):
            parameter, stated = coordinates.parameters[i], ranges[i]
            low, high = (stated.low, stated.high) if stated else (value, value)
            own[parameter.name] = Estimate(
                value,
                min(low, value),
                max(high, value),
                predictor.plant.unit(parameter.unit, placed.place),
                parameter.neutral if np.isfinite(parameter.neutral) else None,
                {name: one for name, some in alone.items() if (one := some[i])},
                _ends(ended[:, i]),
            )
        every.append(own)
    return every


def _ends(values: FloatArray) -> tuple[float, float] | None:
    """The lowest and the highest of some values; None of none."""
    return (float(values.min()), float(values.max())) if len(values) else None


def value_ranges(
    coordinates: Coordinates, x: FloatArray, deviation: FloatArray
) -> list[ValueRange | None]:
    """Values with 80 % intervals at (p,) scaled coordinates; None at those not known.

    `deviation` (p,) are standard deviations, NaN where nothing is known.
    """
    known = np.isfinite(x) & np.isfinite(deviation)
    points = [np.where(known, x + side * Z_80 * deviation, 0.0) for side in (-1, 0, 1)]
    every = zip(*map(coordinates.values_at, points), known, strict=True)
    return [
        ValueRange(value, min(low, value), max(high, value)) if sure else None
        for low, value, high, sure in every
    ]


def largest_errors(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) standard errors, in scaled coordinates, whether recordings differ or not."""
    parts = standard_errors(predictor, fit)
    return np.maximum(parts, errors_between_recordings(predictor, fit))


def standard_errors(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) standard errors of a model's values, in scaled coordinates.

    They are those of White's sandwich estimator of 1980 with blocks of time: no
    simulator is exact, so residuals are correlated and larger than the sensors' noise.
    What the model's tolerances allow is in the residuals' whitening. Recordings may
    differ by more than that: see `spread_of_recordings`. The `fit` has a Jacobian by
    finite differences.
    """
    jacobian, residual = fit.jacobian, fit.residual
    bread = np.linalg.inv(information(jacobian))
    influence = (jacobian * residual[:, None]) @ bread
    variance = block_variance(influence, predictor.block)
    white = np.diag(bread)
    spread = spread_of_recordings(predictor, fit)
    return np.asarray(np.sqrt(np.maximum(np.maximum(variance, white), spread**2)))


def spread_of_joints(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) rms differences, in scaled coordinates, of joints that share a value.

    Each joint's own value follows to first order from its channels, the other values
    staying as they are. 0 for values that are not shared.
    """
    apart = np.zeros(fit.jacobian.shape[1])
    for group in groups_of(fit.model):
        if len(group) == 1:
            continue
        for i in fit.coordinates.columns_of(group):
            shifts = []
            for one in group:
                own = np.isin(predictor.channel, predictor.channels.of_joint(one.place))
                column = fit.jacobian[own, i]
                known = column @ column + 1 / PRIOR_SPREAD**2
                shifts.append(column @ fit.residual[own] / known)
            apart[i] = np.sqrt(np.mean(np.square(shifts)))
    return apart


def spread_of_starts(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) rms distances, in scaled coordinates, to where fits from other values end.

    0 without such fits.
    """
    ends = ends_of_starts(predictor, fit)
    if not len(ends):
        return np.zeros(fit.jacobian.shape[1])
    x = fit.coordinates.of(fit.model)
    return np.asarray(np.sqrt(np.mean((ends - x) ** 2, axis=0)))


def ends_of_starts(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(m, p) scaled coordinates at which fits end that begin at other values.

    Small mismatch is fitted as well. Where replays change at random, as with dry
    friction and play, fits stop anywhere in a valley. None where it is not fitted.
    """
    x, (low, high) = fit.coordinates.of(fit.model), fit.coordinates.bounds()
    nuisance = predictor.nuisance if predictor.fits_nuisance else None
    if nuisance is None:
        return np.empty((0, len(x)))
    sign = (-1) ** np.arange(len(x)), (-1) ** (np.arange(len(x)) // 2)
    starts = np.array([x + STEP * way * one for one in sign for way in (-1, 1)])
    fits = predictor.nuisance_fit(fit.model)
    starts = np.unique(np.clip(starts, low, high), axis=0)
    return fits.ends(nuisance, starts)


def spread_of_softness(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) changes, in scaled coordinates, if parts that are taken as rigid yield.

    How stiff a gear's teeth are, or a stop, recordings hardly tell: values absorb it.
    They follow to first order from the Jacobian, for each effect that may yield.
    """
    plant, model = predictor.plant, fit.model
    softer = [
        (*model[:i], soft, *model[i + 1 :])
        for i, one in enumerate(model)
        if (soft := effect(one.name).softer(plant, one)) != one
    ]
    if not softer:
        return np.zeros(fit.jacobian.shape[1])
    rigid, *left = predictor.residuals([model, *softer])
    absorbed = fit.jacobian.T @ (np.array(left) - rigid).T
    shifts = np.linalg.solve(information(fit.jacobian), absorbed)
    return np.asarray(np.linalg.norm(shifts, axis=1))


def spread_of_recordings(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) standard errors, in scaled coordinates, from leaving out each recording.

    The values without one recording, or part of one, follow to first order from the
    Jacobian (the jackknife: Tukey 1958). 0 if there is only one.
    """
    parts = np.unique(predictor.trace)
    shifts = [_without(fit, predictor.trace != k) for k in parts]
    apart = np.array(shifts) - np.mean(shifts, axis=0)
    return np.asarray(np.sqrt((1 - 1 / len(parts)) * np.sum(apart**2, axis=0)))


def _without(fit: FittedModel, kept: BoolArray) -> FloatArray:
    """(p,) change of the fitted values, in scaled coordinates, by some of the data."""
    jacobian, residual = fit.jacobian[kept], fit.residual[kept]
    return np.asarray(-np.linalg.solve(information(jacobian), jacobian.T @ residual))
