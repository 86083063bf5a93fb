"""How large a concealed effect must be to tell so much: sizes by information.

What a case tells is the log-likelihood that the true physics gains on the nominal
model, in nats per recording: half the squared difference of both motions, in units of
the encoders' noise. Ranges of sizes say little about that: half of one joint's friction
may be thousands of nats, a tenth of another's none.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from worlds.hidden_run import Run
from worlds.hidden_sensors import HiddenSensors

LEVELS = {
    (100.0, 1e5): 0.45,
    (20.0, 100.0): 0.30,
    (5.0, 20.0): 0.15,
    (1.0, 5.0): 0.10,
}
"""Least and most nats per recording of a level, and how often it is drawn."""

LEAST_EASE, MOST_EASE = -1.0, 1.0
NEAR = math.log(1.3)
MOST_TRIALS = 6


def drawn_nats(rng: np.random.Generator) -> float:
    """A level by its share, then even in the logarithm."""
    levels = list(LEVELS)
    low, high = levels[int(rng.choice(len(levels), p=list(LEVELS.values())))]
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def nats(nominal: Sequence[Run], runs: Sequence[Run], sensors: HiddenSensors) -> float:
    """What encoders tell runs from nominal ones by, a recording in the mean.

    Infinite where the physics blew up.
    """
    if not all(run.ok for run in runs):
        return math.inf
    variance = sensors.encoder_rad**2 + sensors.quantum_rad**2 / 12
    told = [
        0.5 * float(np.sum((run.encoder_rad - was.encoder_rad)[was.clock.first :] ** 2))
        for was, run in zip(nominal, runs, strict=True)
    ]
    return sum(told) / len(told) / variance


def ease_that_tells(
    wanted: float, told: Callable[[float], float], first: float
) -> float:
    """The ease at which so much is told, nearly.

    By secants of the logarithm over the ease, in which sizes are even: what is told
    goes with a size's square, so that these are nearly straight.

    Args:
      wanted: nats per recording.
      told: these, at an ease; each call costs runs of a whole case.
      first: the ease to begin with.
    """
    goal = math.log(wanted)
    tried: dict[float, float] = {}
    ease = first
    for _ in range(MOST_TRIALS):
        tried[ease] = math.log(min(max(told(ease), 1e-6), 1e12)) - goal
        if abs(tried[ease]) < NEAR:
            break
        ease = _next(tried)
        if ease in tried:
            break
    return min(tried, key=lambda one: abs(tried[one]))


def _next(tried: dict[float, float]) -> float:
    """Where the line through the two best trials is right, within the range."""
    best, *others = sorted(tried, key=lambda one: abs(tried[one]))
    slope = 6.0  # a size grows twentyfold from hard to easy, so that nats do 400-fold
    if others:
        rise = (tried[others[0]] - tried[best]) / (others[0] - best)
        slope = rise if rise > 1.0 else slope
    ease = best - tried[best] / slope
    return min(max(ease, LEAST_EASE), MOST_EASE)
