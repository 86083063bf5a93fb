"""Makes verdicts, and their effects from fitted values and intervals."""

import time
from collections.abc import Sequence

import numpy as np

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.verdict import Estimate, Found, Recordings, Verdict
from groundwalk.distributions import normal_ppf

NORMAL_80 = normal_ppf(0.9)
"""Half width of an 80 % interval of a normal distribution, in standard deviations."""

_LARGEST = 1e12
"""Finite number that stands for infinite bounds in a verdict."""


def found_effect(
    plant: Plant,
    placed: PlacedEffect,
    spans: Sequence[tuple[float, float]],
    probability: float,
    confusable_with: Sequence[PlacedEffect] = (),
) -> Found:
    """Make an effect of a verdict from its values and their 80 % intervals (low, high).

    Values and intervals are clipped to the parameters' bounds.
    """
    kind = effect(placed.name)
    estimates, parameters = {}, kind.parameters(plant, placed.place)
    for parameter, value, span in zip(parameters, placed.values, spans, strict=True):
        least, most = max(parameter.low, -_LARGEST), min(parameter.high, _LARGEST)
        value, low, high = (
            float(np.clip(np.nan_to_num(each, nan=value), least, most))
            for each in (value, *span)
        )
        unit = plant.unit(parameter.unit, placed.place)
        ends = min(low, value), max(high, value)
        estimates[parameter.name] = Estimate(value, *ends, unit)
    return Found(
        placed.name,
        placed.place,
        estimates,
        float(np.clip(probability, 0.0, 1.0)),
        tuple(PlacedEffect(other.name, other.place) for other in confusable_with),
        native=kind.native,
    )


def verdict_of(
    traces: Sequence[Trace],
    begun_s: float,
    effects: Sequence[Found] = (),
    limits: Sequence[str] = (),
) -> Verdict:
    """The verdict with these effects or none, or with limits that keep it from one.

    All traces count as fitted; the work began at `begun_s` of `time.monotonic`.
    """
    return Verdict(
        "not_identifiable" if limits else "effects" if effects else "none",
        tuple(effects),
        limits=tuple(limits),
        recordings=Recordings(fit=tuple(trace.name for trace in traces)),
        seconds=time.monotonic() - begun_s,
    )
