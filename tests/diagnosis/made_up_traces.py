"""Recordings of a two-link arm whose physics is known."""

from dataclasses import replace

import numpy as np
from joint_rigs import ARM, plant_of, run_from, ticks, trace_of

from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay.replay import replay
from diagnosis.residuals.replays import variants_of

FINE_S = 5e-4
NOISE_RAD = 3e-4
GAINS = {"kp": 40.0, "kd": 2.0}
"""So stiff that links hardly move each other, and damped: a start is soon forgotten."""


def arm(**changes):
    return plant_of(ARM, **{**GAINS, **changes})


def arm_command(time_s, seed=0):
    """(T, 2) sums of sines that begin at rest."""
    random = np.random.default_rng(seed)
    rise = 1 - np.exp(-((time_s / 0.2) ** 2))
    phases, rates = random.uniform(0, 6, (2, 3)), random.uniform(2, 9, (2, 3))
    waves = np.sin(rates[:, :, None] * time_s + phases[:, :, None])
    return (rise * 0.25 * waves.sum(axis=1)).T


def recorded(plant, *effects, duration_s=4.0, seed=0, noise_rad=NOISE_RAD, tick_s=0.02):
    """A trace of a plant with effects (name, place, *values), as the step goes to 0.

    It starts at rest. The start that a replay takes is that of the noisy positions.
    """
    model = tuple(PlacedEffect(name, place, values) for name, place, *values in effects)
    time_s = ticks(duration_s, tick_s)
    trace = trace_of(plant, time_s, command_rad=arm_command(time_s, seed))
    run = run_from(trace)
    fine, finer = (
        replay([run], variants_of(plant, [model]), FINE_S / part)[0].position_rad[0]
        for part in (1, 2)
    )
    noise = np.random.default_rng(seed + 1000).standard_normal((len(time_s), 2))
    return replace(trace, position_rad=2 * finer - fine + noise_rad * noise)
