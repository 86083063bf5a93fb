"""Finds the size at which a hidden effect is as visible as a concealed case demands.

Visibility is measured as information: the log-likelihood by which the true physics
beats the nominal model, in nats per recording. That is half the squared difference of
both motions in units of the encoders' noise. The size alone says little: half of one
joint's friction may give thousands of nats, a tenth of another's none.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from worlds.hidden.recorded import HiddenSensors
from worlds.hidden.run import Run

LEVELS = {"L1": 100.0, "L2": 20.0, "L3": 5.0, "L4": 1.0}
"""Smallest information of each level [nats per recording]; effects of L1 are easy to
see, those of L4 nearly invisible."""

MOST_NATS = 1e5
"""Largest information [nats per recording] that is drawn, in the easiest level, L1."""

SHARES = {"L1": 0.40, "L2": 0.35, "L3": 0.15, "L4": 0.10}
"""Share of the test cases that is drawn for each level; the level measured later, by a
fit of the true effects, is often another one."""

KEPT = 0.6
"""Rough share of the information [nats] that a diagnosis can use: it replays short
windows with fitted start states, which absorb a part of the difference."""

LEAST_EASE, MOST_EASE = -2.0, 1.0
"""Range of the search for the ease, a measure of an effect's size from 0 (hard to see)
to 1 (easy) that may go beyond 0 here."""
NEAR = math.log(1.3)
"""Logarithm of the factor between reached and wanted information at which a search for
the size of an effect ends."""
FAR = math.log(3.0)
"""Logarithm of the factor above which the information of the best trial is too far from
the wanted one: the search then has no result."""
MOST_TRIALS = 8
"""Largest number of trials of a search; each simulates all motions of the test case."""
_LEAST_TOLD, _MOST_TOLD = 0.1, 1e9
"""Bounds [nats] to which an information is clipped before its logarithm is taken."""
_INNER = 0.1
"""Least distance of a trial from the ends of the bracket that encloses the solution, as
a share of its width, so that the bracket shrinks."""


def drawn_nats(rng: np.random.Generator, most_nats: float = MOST_NATS) -> float:
    """Draw an information [nats per recording]: a level, then log-uniform within it.

    `most_nats` is the largest that is drawn.
    """
    ends = [most_nats, *LEVELS.values()]
    level = int(rng.choice(len(LEVELS), p=[SHARES[name] for name in LEVELS]))
    high, low = ends[level], ends[level + 1]
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def level_of(nats_per_recording: float) -> str:
    """Level of difficulty, "L1" (easiest) to "L4", of an information [nats]."""
    *_, last = LEVELS
    reached = (name for name, least in LEVELS.items() if nats_per_recording >= least)
    return next(reached, last)


def nats(nominal: Sequence[Run], runs: Sequence[Run], sensors: HiddenSensors) -> float:
    """Information [nats] about hidden effects in motions, compared with nominal ones.

    It is the median over the recordings, and infinite if a simulation diverged. The
    encoder noise of `sensors` is the unit of differences.
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
    """Find the ease at which an effect gives about the wanted nats; None if none does.

    The ease sets the effect's size: 0 is hard to see, 1 easy. The search is the secant
    method on the logarithm of the nats over the ease, which is nearly linear, because
    sizes are exponential in the ease and nats proportional to the square of a size.
    Trials stay between those with too few and too many nats, because a torque limit or
    an end stop gives no nats at all until it is reached. `told` returns the nats per
    recording at an ease; the `first` trial is at this one.
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

    It is the middle of the bracket instead if that zero is not well inside the bracket,
    or if the trial at its lower end gave no nats at all (the value `nothing`). `tried`
    holds log(nats / wanted nats) by ease.
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
