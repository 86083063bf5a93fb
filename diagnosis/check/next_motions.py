"""Proposes motions to record next: those with which smaller effects would be told."""

from collections.abc import Sequence

import numpy as np

from diagnosis.check.evidence import LEAST_S, Sizes, evidence_of
from diagnosis.check.result import Proposed
from diagnosis.conclude.smallest_sizes import Smallest
from diagnosis.motions.plan import RATE_HZ, Limits, PlannedMotion, planned
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.signatures import signatures_apart
from diagnosis.traces.split import shortened
from diagnosis.traces.trace import Trace

SIMULATED_S = 6.0
"""Most seconds of all proposed motions that are simulated with effects; what they show
grows with the time."""

FITTED = 0.5
"""Share of a recording that is fitted, as a diagnosis divides recordings."""


def next_motions(
    plant: Plant,
    traces: Sequence[Trace],
    channels: Channels,
    now: Sizes,
    threads: int,
    most_rad_s: float | None = None,
) -> list[Proposed]:
    """All motions that keep the limits, with what would be told, the most useful first.

    Recordings of them are taken to have the noise of those given, and their rate, but
    at most 100 rows a second.
    """
    rate_hz = min(RATE_HZ, 1 / max(trace.tick_s for trace in traces))
    limits = Limits.of(plant, traces, most_rad_s)
    motions = planned(plant, limits, traces[0], rate_hz)
    if not motions:
        return []
    whole = [one.trace for one in motions]
    some = shortened(whole, SIMULATED_S, LEAST_S)
    predictor = Predictor(plant, some, _positions(channels, plant), threads=threads)
    predictor.correct()
    lasted_s = [sum(one.duration_s for one in every) for every in (whole, some)]
    weight = FITTED * lasted_s[0] / lasted_s[1]
    tries = [one.placed for one in now.evidence.found]
    evidence = evidence_of(predictor, tries, weight, signatures_apart)
    found = []
    for number, motion in enumerate(motions):
        sizes = now.with_more(evidence.part(number))
        found.append((_use(now.smallest, sizes), number, motion, sizes))
    found.sort(key=lambda one: (-one[0], one[1]))
    return [_proposed(motion, sizes) for _, _, motion, sizes in found]


def _proposed(motion: PlannedMotion, sizes: dict[str, Smallest]) -> Proposed:
    return Proposed(motion, {key: one.told for key, one in sizes.items()})


def _use(now: dict[str, Smallest], then: dict[str, Smallest]) -> float:
    """How useful a motion is: the mean of the logarithms of what sizes shrink by.

    An effect that was not told at all counts as one that was ten times as large.
    """
    gained = [
        _steps(one.factor, one.told is None) - _steps(other.factor, other.told is None)
        for key, other in then.items()
        if (one := now.get(key)) is not None
    ]
    return float(np.mean(gained)) if gained else 0.0


def _steps(factor: float, is_lost: bool) -> float:
    return float(np.log(10.0) if is_lost else np.log(min(max(factor, 1e-9), 10.0)))


def _positions(channels: Channels, plant: Plant) -> Channels:
    """The channels of positions alone: what is planned has no measured torques."""
    own = slice(0, len(plant.joints))
    rounding = np.broadcast_to(channels.rounding, channels.noise.shape)[own]
    return Channels(channels.names[own], channels.noise[own], rounding=rounding)
