"""Measures noise and jitter of the clock in what a model of the robot leaves.

The nominal model shows them only roughly where much is missing in it. So they are
measured again at the best model that was found (`../learned.py`).
"""

import numpy as np

from diagnosis.residuals.channels import MORE_THAN_NOISE, Channels
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.timing.clock import clock_noise, speeds
from diagnosis.residuals.timing.jitter import with_clock, with_shared_clock


def clock_at(
    predictor: Predictor, model: Model, found: Channels
) -> tuple[Channels, bool]:
    """The channels with the jitter of time stamps that a model leaves in recordings.

    If the model, with small mismatch, leaves much more than noise in most channels,
    only the jitter that all channels share is measured.

    Args:
      predictor: predictor of the recordings, calibrated at the model.
      model: effects that the robot has.
      found: the channels with noise that includes what jitter adds on average.

    Returns:
      the channels, and whether the model leaves so much.
    """
    given, beside = predictor.channels, predictor.moved_to(model)
    shape = -1, len(found.names)
    left = beside.evenly().residuals([model]).reshape(shape) * given.noise / found.noise
    scored, speed = predictor.scored.reshape(shape), speeds(predictor.traces, found)
    timed = with_clock(found, left, speed, scored)
    white = beside.without_tolerances().residuals([model]).reshape(shape)
    if not given.jitter_s:
        clock = clock_noise(predictor.traces, timed, scored)
        white = white * given.noise / timed.noise
        white = white if clock is None else clock.without(white[None])[0]
    square = np.sum(white**2, axis=0) / np.maximum(scored.sum(axis=0), 1)
    count = np.sum(square > MORE_THAN_NOISE**2)
    if count < max(len(square) / 2, 2):
        return timed, False
    return with_shared_clock(found, left, speed, scored), True
