"""Baseline: fits single effects; the Bayesian information criterion chooses one."""

import time
from collections.abc import Sequence

import numpy as np

from diagnosis.baselines.found import NORMAL_80, found_effect, verdict_of
from diagnosis.baselines.replays import exact_replays
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.signatures import signatures
from diagnosis.residuals.torques.ripples import usage_of
from diagnosis.search.fitting import FittedModel, fit_all
from diagnosis.search.screening import Screen
from diagnosis.traces.reference import Reference
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Verdict
from groundwalk.arrays import FloatArray

CANDIDATES = 12
"""Number of candidates (effects at places) that are fitted, those with the best first
guesses; each fit takes many simulations."""

CONFUSABLE = 10.0
"""Difference of BIC to the best effect below which another effect counts as possible,
too; larger ones are "very strong" evidence (Kass and Raftery 1995)."""


def answer(
    plant: Plant, traces: Sequence[Trace], reference: Reference | None = None
) -> Verdict:
    """Name the effect with the least BIC = 2 energy + p ln n, or no effect.

    Here energy is half the sum of squared residuals in units of noise, p the number of
    parameters and n the number of samples. Source: Schwarz 1978, "Estimating the
    dimension of a model". `reference` are recordings of the healthy robot: what they
    show is taken as given.
    """
    begun_s = time.monotonic()
    predictor = exact_replays(plant, traces, reference, explained)
    fits, criteria = singles(predictor)
    weights = np.exp(-0.5 * (criteria - criteria.min()))
    weights /= weights.sum()
    best = int(np.argmin(criteria)) - 1
    if best < 0:
        return verdict_of(traces, begun_s)
    close = [
        fit.model[0]
        for fit, value in zip(fits, criteria[1:], strict=True)
        if fit is not fits[best] and value < criteria[best + 1] + CONFUSABLE
    ]
    # fit the best one again, for a Jacobian computed at its own values
    (fit,) = fit_all(predictor, [fits[best].model])
    placed, spans = fit.model[0], intervals(fit)
    named = found_effect(plant, placed, spans, weights[best + 1], close)
    return verdict_of(traces, begun_s, (named,))


def explained(predictor: Predictor) -> Model:
    """The single effect, with values, that BIC prefers to none; () if there is none."""
    fits, criteria = singles(predictor)
    best = int(np.argmin(criteria)) - 1
    return () if best < 0 else fits[best].model


def singles(predictor: Predictor) -> tuple[list[FittedModel], FloatArray]:
    """Fits of the most promising effects, and BIC of no effect and of each of them."""
    residual = predictor.residuals([()])[0]
    found = signatures(predictor, (), usage_of(predictor))
    guesses = Screen(predictor, found).singles(residual)[:CANDIDATES]
    fits = fit_all(predictor, [guess.model for guess in guesses], followed=True)
    samples = int(predictor.scored.sum())
    values = [criterion(fit, samples) for fit in fits]
    return fits, np.array([float(residual @ residual), *values])


def criterion(fit: FittedModel, samples: int) -> float:
    """BIC (Bayesian information criterion) of a fit, less what all fits share."""
    return 2 * fit.energy + float(fit.jacobian.shape[1] * np.log(samples))


def intervals(fit: FittedModel) -> list[tuple[float, float]]:
    """80 % intervals (low, high) of the values of a fit, for white residual noise."""
    information = fit.jacobian.T @ fit.jacobian
    variance = np.diag(np.linalg.pinv(information))
    x = fit.coordinates.of(fit.model)
    half: FloatArray = NORMAL_80 * np.sqrt(np.maximum(variance, 0.0))
    inside = [np.clip(x + sign * half, *fit.coordinates.bounds()) for sign in (-1, 1)]
    ends = [fit.coordinates.model_at(one) for one in inside]
    low, high = ([v for placed in model for v in placed.values] for model in ends)
    return list(zip(low, high, strict=True))
