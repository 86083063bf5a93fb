"""Recordings of one arm whose servo gain differs from recording to recording."""

from dataclasses import replace
from functools import cache

import numpy as np
from made_up_traces import NOISE_RAD, arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor

CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
GAIN = (PlacedEffect("servo_gain", "elbow", (1.03,)),)


@cache
def predictor_of(gains, first=0, model=GAIN):
    """A predictor of one recording for each gain of the elbow's servo.

    Seeds and names count from `first`; it is calibrated at `model`.
    """
    traces = [
        replace(
            recorded(arm(), ("servo_gain", "elbow", gain), seed=first + k),
            name=f"recording {first + k}",
        )
        for k, gain in enumerate(gains)
    ]
    found = Predictor(arm(), traces, CHANNELS)
    found.calibrate(model, tolerances=False)
    return found
