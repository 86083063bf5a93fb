"""What each recording says of fitted values alone, and how much recordings differ."""

import numpy as np

from diagnosis.conclude.block_errors import block_variance, information
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import FittedModel
from groundwalk.arrays import FloatArray

LEAST_SHARE = 1e-3
"""Share of what all recordings tell of a value from which on one tells something."""


def said_alone(
    predictor: Predictor, fit: FittedModel
) -> dict[str, tuple[FloatArray, FloatArray]]:
    """By recording the (p,) values that it says alone, and their standard errors.

    In scaled coordinates, to first order from the Jacobian; NaN where a recording says
    nothing. Empty for a single recording: it says what is stated.
    """
    names, shares, shifts = _of_each(predictor, fit)
    if len(names) < 2:
        return {}
    x, squared = fit.coordinates.of(fit.model), _squared_errors(predictor, fit)
    tells = shares > LEAST_SHARE
    weight = np.where(tells, shares, np.nan)
    every = zip(names, x + shifts / weight, np.sqrt(squared / weight), strict=True)
    return {name: (own, error) for name, own, error in every}


def errors_between_recordings(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) standard errors, in scaled coordinates, if recordings truly differ.

    A value may be another one in each recording, as a delay is that a bus and a motor
    make together; parts of one recording then agree. How much recordings differ beyond
    their errors follows from the values that each of them tells (DerSimonian and Laird
    1986, "Meta-analysis in clinical trials"), to first order from the Jacobian.
    """
    _, shares, shifts = _of_each(predictor, fit)
    error = _squared_errors(predictor, fit)
    found = error.copy()
    for i, squared in enumerate(error):
        tells = shares[:, i] > LEAST_SHARE
        weight = shares[tells, i]
        value = shifts[tells, i] / weight
        if tells.sum() > 1:
            found[i] += _between(value, weight / squared) * np.sum(weight**2)
    return np.asarray(np.sqrt(found))


def _of_each(
    predictor: Predictor, fit: FittedModel
) -> tuple[list[str], FloatArray, FloatArray]:
    """Names of k recordings, their (k, p) shares of what is known, and their shifts.

    A shift is by how much a recording moves a value, times its share.
    """
    bread = np.linalg.inv(information(fit.jacobian))
    every = [trace.recording for trace in predictor.traces]
    names, number = np.unique(every, return_inverse=True)
    own = number[predictor.trace]
    parts = [fit.jacobian * (own == k)[:, None] for k in range(len(names))]
    shares = np.array([np.diag(bread @ one.T @ one) for one in parts])
    shifts = np.array([-bread @ one.T @ fit.residual for one in parts])
    return names.tolist(), shares, shifts


def _squared_errors(predictor: Predictor, fit: FittedModel) -> FloatArray:
    """(p,) squared standard errors of values if recordings do not differ."""
    bread = np.linalg.inv(information(fit.jacobian))
    influence = (fit.jacobian * fit.residual[:, None]) @ bread
    return np.maximum(block_variance(influence, predictor.block), np.diag(bread))


def _between(values: FloatArray, weights: FloatArray) -> float:
    """Variance of k values beyond that of their errors, 1 / weights; 0 if not more."""
    total = float(weights.sum())
    scatter = float(weights @ (values - weights @ values / total) ** 2)
    beyond = scatter - (len(values) - 1)
    return max(beyond / (total - float(weights @ weights) / total), 0.0)
