"""Residuals of two traces that nobody has simulated."""

from dataclasses import replace

import numpy as np
from made_up_traces import arm, recorded

from diagnosis.residuals.predictor import Channels, Predictor

CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, 4e-4))
START_S = 5.0


def two_traces():
    """A predictor of six seconds each, on clocks that do not begin at 0."""
    plant = arm()
    traces = [recorded(plant, duration_s=6.0, seed=seed) for seed in range(2)]
    traces = [
        replace(trace, name=f"trace {k}", time_s=trace.time_s + START_S)
        for k, trace in enumerate(traces)
    ]
    return Predictor(plant, traces, CHANNELS)


def time_of(predictor):
    return np.concatenate([np.repeat(t.time_s, 2) for t in predictor.traces])


def noise(predictor, seed=0):
    random = np.random.default_rng(seed)
    return predictor.scored * random.standard_normal(len(predictor.scored))


def pushed(predictor, first_s, last_s, size=12.0, trace=1, channel=1):
    time_s = time_of(predictor)
    rows = (predictor.trace == trace) & (predictor.channel == channel)
    rows &= (time_s >= first_s) & (time_s < last_s)
    return noise(predictor) + size * rows
