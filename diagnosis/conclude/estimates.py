"""How well the values of a fitted model are known."""

import itertools
from collections.abc import Mapping

import numpy as np

from diagnosis.conclude.block_variance import block_variance
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import Fit
from diagnosis.verdict.verdict import Estimate
from groundwalk.arrays import FloatArray

Z_80 = 1.2815515655446004
"""Quantile of the normal distribution: 80 % lie within as many standard deviations."""

PRIOR_SPREAD = 10.0
"""Of coordinates, which are of order one: what data do not show is open that far."""

SYSTEMATIC = 0.015
"""Of a value: what sims of the same physics disagree by, whatever the data."""


def estimates(predictor: Predictor, fit: Fit) -> list[Mapping[str, Estimate]]:
    """For each effect of the model its values with 80 % intervals, by their names."""
    deviation = standard_errors(predictor, fit)
    x = fit.coordinates.of(fit.model)
    ends = np.array([_values(fit, x + side * Z_80 * deviation) for side in (-1, 1)])
    values = [value for placed in fit.model for value in placed.values]
    parameters = fit.coordinates.parameters
    places = [placed.place for placed in fit.model for _ in placed.values]
    units = [
        predictor.plant.unit(parameter.unit, place)
        for parameter, place in zip(parameters, places, strict=True)
    ]
    every = [
        Estimate(value, min(*pair, value), max(*pair, value), unit)
        for value, pair, unit in zip(values, ends.T.tolist(), units, strict=True)
    ]
    names = [parameter.name for parameter in parameters]
    counts = np.cumsum([0, *(len(placed.values) for placed in fit.model)])
    return [
        dict(zip(names[first:last], every[first:last], strict=True))
        for first, last in itertools.pairwise(counts.tolist())
    ]


def standard_errors(predictor: Predictor, fit: Fit) -> FloatArray:
    """(p,) of the values' coordinates.

    The sandwich of White 1980 with blocks: residuals are neither white nor of the
    variance that the sensors' noise has, as no sim is exact; blocks that are alike are
    joined. What is not in the data,
    a common error of all sims, is added as a part of each value.
    """
    jacobian, residual = fit.jacobian, fit.residual
    known = jacobian.T @ jacobian + np.eye(jacobian.shape[1]) / PRIOR_SPREAD**2
    bread = np.linalg.inv(known)
    influence = (jacobian * residual[:, None]) @ bread
    variance = block_variance(influence, predictor.block)
    white = np.diag(bread)
    systematic = [
        SYSTEMATIC if p.logarithmic else SYSTEMATIC * abs(c - _neutral(fit, i))
        for i, (p, c) in enumerate(
            zip(fit.coordinates.parameters, fit.coordinates.of(fit.model), strict=True)
        )
    ]
    return np.asarray(np.sqrt(np.maximum(variance, white) + np.square(systematic)))


def _neutral(fit: Fit, index: int) -> float:
    """Coordinate at which a value does nothing; 0 where that is infinitely far."""
    neutral = fit.coordinates.scaled(index, fit.coordinates.parameters[index].neutral)
    return neutral if np.isfinite(neutral) else 0.0


def _values(fit: Fit, x: FloatArray) -> list[float]:
    return [value for placed in fit.coordinates.model_at(x) for value in placed.values]
