"""Finds the size at which a hidden effect shows as clearly as a case demands.

How clearly it shows is measured by information: the log-likelihood that the true
physics gains over the nominal model, in nats per recording. That is half the squared
difference of both motions in units of the encoders' noise. The size itself says little:
half of one joint's friction may give thousands of nats, a tenth of another's none.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from worlds.hidden.recorded import HiddenSensors
from worlds.hidden.run import Run

LEVELS = {"L1": 100.0, "L2": 20.0, "L3": 5.0, "L4": 1.0}
"""Levels from easy to see to nearly invisible, with their least nats per recording."""

MOST_NATS = 1e5
"""Most nats per recording that are drawn, in the easiest level."""

SHARES = {"L1": 0.40, "L2": 0.35, "L3": 0.15, "L4": 0.10}
"""Share of cases that are drawn for each level. The second level is narrow and gets
many: the level that is later measured by a fit of the true effects often misses it."""

KEPT = 0.6
"""Share of the nats that a diagnosis can see: it replays short windows, each with its
own start state, which takes up a part of the difference. A rough value: levels are
measured later."""

LEAST_EASE, MOST_EASE = -2.0, 1.0
"""Range in which the ease is sought; sizes are drawn from 0 to 1."""
NEAR = math.log(1.3)
"""The search ends when the nats are right within this factor (as a logarithm)."""
FAR = math.log(3.0)
"""A best trial that is off by more than this factor (as a logarithm) is no answer."""
MOST_TRIALS = 8
"""Trials of a search; each simulates all motions of the case."""
_LEAST_TOLD, _MOST_TOLD = 0.1, 1e9
"""Nats are kept within these bounds before their logarithm is taken."""
_INNER = 0.1
"""A trial keeps this share of the bracket away from the bracket's ends."""


def drawn_nats(rng: np.random.Generator) -> float:
    """Draw nats per recording: a level by its share, then evenly in the logarithm."""
    ends = [MOST_NATS, *LEVELS.values()]
    level = int(rng.choice(len(LEVELS), p=[SHARES[name] for name in LEVELS]))
    high, low = ends[level], ends[level + 1]
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def level_of(nats_per_recording: float) -> str:
    """The easiest level whose least nats are reached; otherwise the last level."""
    *_, last = LEVELS
    reached = (name for name, least in LEVELS.items() if nats_per_recording >= least)
    return next(reached, last)


def nats(nominal: Sequence[Run], runs: Sequence[Run], sensors: HiddenSensors) -> float:
    """Nats by which motions with hidden effects differ from nominal ones.

    The median over the recordings: an effect that shows in only one of them can be
    neither learned from the others nor confirmed there. Infinite where the physics blew
    up.

    Args:
      nominal: motions with nothing hidden, one a recording.
      runs: the same motions with the hidden effects.
      sensors: whose noise counts.
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
    """The ease at which recordings tell nearly the wanted nats; None if none does.

    By the secant method on the logarithm of the nats over the ease. Sizes are
    exponential in the ease and nats go with the square of a size, so that this function
    is nearly straight. Trials stay between those with too few and too many nats: a
    torque limit or an end stop gives no nats at all until it is reached.

    Args:
      wanted: nats per recording.
      told: gives the nats at an ease; each call simulates all motions of a case.
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
    """The next ease to try: the zero of the line through the two best trials.

    The middle of the bracket is tried instead where that zero is not well inside the
    bracket, or where the lower trial gave no nats at all.

    Args:
      tried: by ease, logarithm of the nats over the wanted nats.
      nothing: that logarithm where there are no nats.
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
