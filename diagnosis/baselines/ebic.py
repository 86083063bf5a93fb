"""Baseline: stepwise regression with replays; the extended BIC says when to stop."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.baselines.bic import CONFUSABLE, criterion, intervals
from diagnosis.baselines.found import found_effect, verdict_of
from diagnosis.baselines.replays import exact_replays
from diagnosis.effects.library import all_effects
from diagnosis.effects.parts import PlacedEffect
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
"""Number of effects that are fitted in each step, those with the best linear guesses
beside the effects that are in the model already."""

MOST_EFFECTS = 8
"""Most effects of an answer, so that each case ends; the criterion mostly ends it
before."""


@dataclass(frozen=True, eq=False)
class Step:
    """One step: the model with one more effect, and how sure that effect was.

    The `weight` is exp(-EBIC / 2) of this model as a share of those of all models that
    were fitted in the step, and of the one without; effects `close` to the chosen one
    have nearly its EBIC.
    """

    fit: FittedModel
    weight: float
    close: tuple[PlacedEffect, ...]

    @property
    def key(self) -> str:
        """The effect that the step adds, such as "backlash@knee"."""
        return self.fit.model[-1].key


def answer(
    plant: Plant, traces: Sequence[Trace], reference: Reference | None = None
) -> Verdict:
    """Add effects while the extended BIC falls, then drop some while it falls.

    EBIC = 2 energy + p ln n + 2 k ln P for half the sum of squared residuals (energy),
    p values of k effects, n samples and P candidates, effects at places (Chen and Chen
    2008, "Extended Bayesian information criteria for model selection with large model
    spaces", gamma = 1). Each time the best effect is added, and earlier ones are fitted
    again. `reference` are recordings of the healthy robot: what they show is taken as
    given.
    """
    begun_s = time.monotonic()
    predictor = exact_replays(plant, traces, reference, explained)
    steps = {step.key: step for step in stepwise(predictor)}
    if not steps:
        return verdict_of(traces, begun_s)
    model = without_idle(predictor, list(steps.values())[-1].fit)
    # fit once more, for a Jacobian computed at the final values
    (fit,) = fit_all(predictor, [model])
    spans = iter(intervals(fit))
    named = []
    for placed in fit.model:
        own, step = [next(spans) for _ in placed.values], steps[placed.key]
        named.append(found_effect(plant, placed, own, step.weight, step.close))
    named.sort(key=lambda one: -(one.probability or 0.0))
    return verdict_of(traces, begun_s, named)


def explained(predictor: Predictor) -> Model:
    """The effects, with values, that stepwise regression finds."""
    steps = stepwise(predictor)
    return without_idle(predictor, steps[-1].fit) if steps else ()


def stepwise(predictor: Predictor) -> list[Step]:
    """The steps by which the extended BIC falls; `predictor` must be calibrated."""
    found = signatures(predictor, (), usage_of(predictor))
    if not found:
        return []
    screen = Screen(predictor, found)
    candidates, samples = _counts(predictor)
    residual = predictor.residuals([()])[0]
    now, steps = float(residual @ residual), list[Step]()
    jacobian = None
    while len(steps) < MOST_EFFECTS:
        model = steps[-1].fit.model if steps else ()
        used = {placed.key for placed in model}
        guesses = [
            guess.model
            for guess in screen.singles(residual, jacobian)
            if guess.model[0].key not in used
        ]
        if not guesses:
            break
        fits = fit_all(
            predictor, [(*model, *one) for one in guesses[:CANDIDATES]], followed=True
        )
        values = np.array([extended(fit, samples, candidates) for fit in fits])
        best = int(np.argmin(values))
        if values[best] >= now:
            break
        steps.append(_step(fits, values, now))
        now = float(values[best])
        residual, jacobian = fits[best].residual, fits[best].jacobian
    return steps


def without_idle(predictor: Predictor, fit: FittedModel) -> Model:
    """The model less effects without which, the others refitted, the criterion falls.

    The last one stays in any case.
    """
    candidates, samples = _counts(predictor)
    now = extended(fit, samples, candidates)
    while len(fit.model) > 1:
        fewer = [fit.model[:i] + fit.model[i + 1 :] for i in range(len(fit.model))]
        fits = fit_all(predictor, fewer, followed=True)
        values = [extended(one, samples, candidates) for one in fits]
        best = int(np.argmin(values))
        if values[best] >= now:
            break
        fit, now = fits[best], values[best]
    return fit.model


def _counts(predictor: Predictor) -> tuple[int, int]:
    """Number of candidates, effects at places, and of samples."""
    places = [
        kind.places(predictor.plant, predictor.traces)
        for kind in all_effects().values()
    ]
    return sum(map(len, places)), int(predictor.scored.sum())


def extended(fit: FittedModel, samples: int, candidates: int) -> float:
    """The extended BIC of a fit, less what all fits share."""
    return criterion(fit, samples) + 2 * len(fit.model) * math.log(candidates)


def _step(fits: Sequence[FittedModel], values: FloatArray, before: float) -> Step:
    """The best of the fits of a step, beside the model before it."""
    best = int(np.argmin(values))
    weights = np.exp(-0.5 * (np.array([*values, before]) - values[best]))
    close = [
        fit.model[-1]
        for fit, value in zip(fits, values, strict=True)
        if fit is not fits[best] and value < values[best] + CONFUSABLE
    ]
    return Step(fits[best], float(1.0 / weights.sum()), tuple(close))
