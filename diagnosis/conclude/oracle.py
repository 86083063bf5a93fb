"""Fits effects that are known to be true, to see what a perfect diagnosis would reach.

A diagnosis has to find which effects a sim lacks. If these are known, as in recordings
made with hidden physics, fitting only their sizes shows how clearly the recordings tell
them, and how small the error can get.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.search.reference import learn_reference
from diagnosis.traces.reference import Reference
from diagnosis.traces.split import split
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.blas import one_blas_thread


@dataclass(frozen=True)
class StructureFit:
    """Rms errors, in units of noise, on held-out recordings.

    They are of the nominal model, the fitted structure (true effects) and other models.
    `gain` is the mean over all recordings of the log-likelihood [nats] by which the
    fitted structure beats the nominal model.
    """

    gain: float
    nominal: float
    fitted: float
    others: tuple[float, ...]


@one_blas_thread
def fit_structure(
    plant: Plant,
    traces: Sequence[Trace],
    reference: Reference | None,
    structure: Model,
    others: Sequence[Model] = (),
) -> StructureFit:
    """Fit the values of a known structure (the true effects); compare other models.

    The values are fitted to the same recordings that a diagnosis fits. The other
    models, such as the answers of a diagnosis, keep the values they are given.
    `reference` are recordings of the healthy robot, if any.
    """
    parts = split(traces)
    healthy = reference.traces if reference else ()
    channels = shared_channels(plant, [*traces, *healthy])
    noise = learn_reference(reference.plant, healthy, channels) if reference else None
    fitting = Predictor(plant, parts.fit, channels, noise=noise)
    fitting.calibrate(structure)
    model = fit_all(fitting, [structure])[0].model
    used = [*parts.fit, *parts.select, *parts.test]
    every = Predictor(plant, used, channels, noise=noise)
    every.calibrate(model)
    residuals = every.nominal().residuals([(), model, *others])
    held_out = every.trace >= len(parts.fit) + len(parts.select)
    error = np.sqrt(np.mean(residuals[:, held_out & every.scored] ** 2, axis=1))
    gain = log_score_gain(residuals[0], residuals[1], every.channel) / len(traces)
    nominal, fitted, *rest = map(float, error)
    return StructureFit(gain, nominal, fitted, tuple(rest))


def log_score_gain(nominal: FloatArray, fitted: FloatArray, channel: IntArray) -> float:
    """Log-likelihood [nats] by which a fitted model beats the nominal one.

    Errors are taken as Gaussian. Error that the fitted model cannot explain, such as
    the difference between two engines, counts as noise: a channel's variance is the
    larger of its sensor's and of the fitted model's mean squared error. Residuals (N,)
    are in units of the sensor's noise, 0 where not scored; `channel` (N,) are their
    channels.
    """
    gain = 0.0
    for number in np.unique(channel):
        seen = (channel == number) & ((nominal != 0) | (fitted != 0))
        if seen.any():
            variance = max(1.0, float(np.mean(fitted[seen] ** 2)))
            less = float(np.sum(nominal[seen] ** 2 - fitted[seen] ** 2))
            gain += 0.5 * less / variance
    return gain
