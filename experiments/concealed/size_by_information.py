"""How large a concealed effect must be to tell so much: sizes by information.

What a case tells is the log-likelihood that the true physics gains on the nominal
model, in nats per recording: half the squared difference of both motions, in units of
the encoders' noise, of which replays in short windows keep a part. Ranges of sizes say
little about that: half of one joint's friction may be thousands of nats, a tenth of
another's none.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from worlds.hidden.recorded import HiddenSensors
from worlds.hidden.run import Run

LEVELS = {"L1": 100.0, "L2": 20.0, "L3": 5.0, "L4": 1.0}
"""From easy to see to next to invisible; the least nats per recording ..."""

MOST_NATS = 1e5
"""... and the most of the first."""

SHARES = {"L1": 0.40, "L2": 0.35, "L3": 0.15, "L4": 0.10}
"""How often a level is drawn. The second is narrow: what a fit of the truth tells then
often lies beside it."""

KEPT = 0.6
"""Of the nats by which whole motions differ, in replays of windows that start anew."""

LEAST_EASE, MOST_EASE = -2.0, 1.0
NEAR = math.log(1.3)
FAR = math.log(3.0)
MOST_TRIALS = 8
_LEAST_TOLD, _MOST_TOLD = 0.1, 1e9
_INNER = 0.1


def drawn_nats(rng: np.random.Generator) -> float:
    """A level by its share, then even in the logarithm."""
    ends = [MOST_NATS, *LEVELS.values()]
    level = int(rng.choice(len(LEVELS), p=[SHARES[name] for name in LEVELS]))
    high, low = ends[level], ends[level + 1]
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def level_of(nats_per_recording: float) -> str:
    """The first level that is reached, or the last."""
    *_, last = LEVELS
    reached = (name for name, least in LEVELS.items() if nats_per_recording >= least)
    return next(reached, last)


def nats(nominal: Sequence[Run], runs: Sequence[Run], sensors: HiddenSensors) -> float:
    """What a replay would tell runs from nominal ones by, in the recordings' median.

    What shows in one of them only cannot be learned from others, nor shown to hold
    there. Infinite where the physics blew up.
    """
    if not all(run.ok for run in runs):
        return math.inf
    variance = sensors.encoder_rad**2 + sensors.quantum_rad**2 / 12
    told = [
        0.5 * float(np.sum((run.encoder_rad - was.encoder_rad)[was.clock.first :] ** 2))
        for was, run in zip(nominal, runs, strict=True)
    ]
    return float(KEPT * np.median(told)) / variance


def ease_that_tells(
    wanted: float, told: Callable[[float], float], first: float
) -> float | None:
    """The ease at which so much is told, nearly; None if no size tells it.

    By secants of the logarithm over the ease, in which sizes are even: what is told
    goes with a size's square, so that these are nearly straight. They stay between
    trials that told too little and too much, since a limit or an end stop tells
    nothing at all until it is reached.

    Args:
      wanted: nats per recording.
      told: these, at an ease; each call costs runs of a whole case.
      first: the ease to begin with.
    """
    goal = math.log(wanted)
    tried: dict[float, float] = {}
    ease = first
    for _ in range(MOST_TRIALS):
        tried[ease] = math.log(min(max(told(ease), _LEAST_TOLD), _MOST_TOLD)) - goal
        if abs(tried[ease]) < NEAR:
            break
        ease = _next(tried, math.log(_LEAST_TOLD) - goal)
        if ease in tried:
            break
    best = min(tried, key=lambda one: abs(tried[one]))
    return best if abs(tried[best]) < FAR else None


def _next(tried: dict[float, float], nothing: float) -> float:
    """Where the line through the two best trials is right, within the range.

    Halfway where that is not well between too little and too much, or where the little
    is nothing at all, of which no line can be drawn.
    """

    def off(one: float) -> tuple[float, float]:
        return abs(tried[one]), one * math.copysign(1.0, tried[one])

    best, *others = sorted(tried, key=off)
    slope = 6.0  # a size grows twentyfold from hard to easy, so that nats do 400-fold
    if others:
        rise = (tried[others[0]] - tried[best]) / (others[0] - best)
        slope = rise if rise > 1.0 else slope
    low = max((one for one in tried if tried[one] < 0), default=None)
    high = min((one for one in tried if tried[one] > 0), default=None)
    ease = best - tried[best] / slope
    if low is not None and high is not None and low < high:
        margin = _INNER * (high - low)
        inside = low + margin <= ease <= high - margin
        if tried[low] <= nothing or not inside:
            ease = (low + high) / 2
    return min(max(ease, LEAST_EASE), MOST_EASE)
