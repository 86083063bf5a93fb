"""Intervals for fitted values."""

from collections.abc import Mapping

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.residuals.coordinates import STEP
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.ties import groups_of
from diagnosis.search.fitting import FittedModel
from diagnosis.verdict import Estimate
from groundwalk.arrays import BoolArray, FloatArray, IntArray

Z_80 = 1.2815515655446004
"""Half width of an 80 % interval of the normal distribution, in standard deviations."""

PRIOR_SPREAD = 10.0
"""Standard deviation of the prior on values, in coordinates scaled to be of order one:
values that the data do not determine get intervals about this wide."""

FEWEST = 8
"""Fewest time blocks from which a correlation of the errors in neighbouring ones is
estimated."""

LEAST_SHARE = 1e-3
"""Share of what all recordings tell of a value from which on one tells something."""

SIGNIFICANT = 2.0
"""A correlation of the errors in neighbouring time blocks counts as real from this
multiple of the standard deviation that chance gives it."""


def estimates(predictor: Predictor, fit: FittedModel) -> list[Mapping[str, Estimate]]:
    """For each effect its values with 80 % intervals and units, by parameter name.

    Where joints share a value, the interval is that of the value at one of them: it is
    as wide as joints differ. The `fit` to the predictor's data has a Jacobian by finite
    differences.
    """
    spreads = largest_errors, spread_of_joints, spread_of_starts, spread_of_softness
    deviation = np.linalg.norm([one(predictor, fit) for one in spreads], axis=0)
    x = fit.coordinates.of(fit.model)
    ends = np.array(
        [fit.coordinates.values_at(x + side * Z_80 * deviation) for side in (-1, 1)]
    )
    every: list[Mapping[str, Estimate]] = []
    for placed, columns in zip(fit.model, fit.coordinates.columns, strict=True):
        own = {}
        for value, i in zip(placed.values, columns, strict=True):
            parameter, pair = fit.coordinates.parameters[i], ends[:, i].tolist()
            unit = predictor.plant.unit(parameter.unit, placed.place)
            low, high = min(*pair, value), max(*pair, value)
            own[parameter.name] = Estimate(value, low, high, unit)
        every.append(own)
    return every


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
    bread = np.linalg.inv(_information(jacobian))
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

    Small mismatch is fitted as well. Where replays change at random, as with dry
    friction and play, fits stop anywhere in a valley. 0 where it is not fitted.
    """
    x, (low, high) = fit.coordinates.of(fit.model), fit.coordinates.bounds()
    nuisance = predictor.nuisance if predictor.fits_nuisance else None
    if nuisance is None:
        return np.zeros(len(x))
    sign = (-1) ** np.arange(len(x)), (-1) ** (np.arange(len(x)) // 2)
    starts = np.array([x + STEP * way * one for one in sign for way in (-1, 1)])
    fits = predictor.nuisance_fit(fit.model)
    starts = np.unique(np.clip(starts, low, high), axis=0)
    ends = fits.ends(nuisance, starts)
    return np.asarray(np.sqrt(np.mean((ends - x) ** 2, axis=0)))


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
    shifts = np.linalg.solve(_information(fit.jacobian), absorbed)
    return np.asarray(np.linalg.norm(shifts, axis=1))


def errors_between_recordings(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) standard errors, in scaled coordinates, if recordings truly differ.

    A value may be another one in each recording, as a delay is that a bus and a motor
    make together; parts of one recording then agree. How much recordings differ beyond
    their errors follows from the values that each of them tells (DerSimonian and Laird
    1986, "Meta-analysis in clinical trials"), to first order from the Jacobian.
    """
    bread = np.linalg.inv(_information(fit.jacobian))
    names = [trace.recording for trace in predictor.traces]
    own = np.unique(names, return_inverse=True)[1][predictor.trace]
    every = [fit.jacobian * (own == k)[:, None] for k in np.unique(own)]
    shares = np.array([np.diag(bread @ one.T @ one) for one in every])
    shifts = np.array([-bread @ one.T @ fit.residual for one in every])
    influence = (fit.jacobian * fit.residual[:, None]) @ bread
    white = np.diag(bread)
    error = np.maximum(block_variance(influence, predictor.block), white)
    found = error.copy()
    for i, squared in enumerate(error):
        tells = shares[:, i] > LEAST_SHARE
        weight = shares[tells, i]
        value = shifts[tells, i] / weight
        if tells.sum() > 1:
            found[i] += _between(value, weight / squared) * np.sum(weight**2)
    return np.asarray(np.sqrt(found))


def _between(values: FloatArray, weights: FloatArray) -> float:
    """Variance of k values beyond that of their errors, 1 / weights; 0 if not more."""
    total = float(weights.sum())
    scatter = float(weights @ (values - weights @ values / total) ** 2)
    beyond = scatter - (len(values) - 1)
    return max(beyond / (total - float(weights @ weights) / total), 0.0)


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
    information = _information(jacobian)
    return np.asarray(-np.linalg.solve(information, jacobian.T @ residual))


def _information(jacobian: FloatArray) -> FloatArray:
    """(p, p) information on the values in a fit with this (N, p) Jacobian."""
    prior = np.eye(jacobian.shape[1]) / PRIOR_SPREAD**2
    return np.asarray(jacobian.T @ jacobian + prior)


def block_variance(influence: FloatArray, block: IntArray) -> FloatArray:
    """(p,) variances of fitted values if residuals of one time block are correlated.

    The influences are summed within each block and the squares of the sums are added,
    which is right if blocks are independent. If neighbouring blocks are significantly
    correlated, they are joined in pairs until they are not: friction that varies with
    the position, for example, causes an error as long as a stroke lasts.

    `influence` (N, p) is the change of each value by each entry of the residual,
    `block` (N,) the number of each entry's time block, increasing with time.
    """
    sums = np.zeros((int(block.max()) + 1, influence.shape[1]))
    np.add.at(sums, block, influence)
    return np.array([_variance(column) for column in sums.T])


def _variance(sums: FloatArray) -> float:
    """Variance of an estimated value from (blocks,) shifts of it by each time block."""
    variance = float(sums @ sums)
    if len(sums) < FEWEST or variance <= 0:
        return variance
    alike = float(sums[1:] @ sums[:-1]) / variance
    if alike < SIGNIFICANT / np.sqrt(len(sums)):
        return variance
    padded = np.append(sums, 0.0) if len(sums) % 2 else sums
    return _variance(padded.reshape(-1, 2).sum(axis=1))
