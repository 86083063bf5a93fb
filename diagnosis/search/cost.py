"""Estimates how long a diagnosis will take, from one small batch of simulations."""

import time
from collections.abc import Sequence

from diagnosis.effects.library import all_effects
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.data_sets import affordable
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.traces.split import split
from diagnosis.traces.trace import Trace

REPLAYS = {"fixed": 600, "floating": 1500}
"""Typical number of simulations of the fitting data in one diagnosis, by the robot's
base. Six test cases with a fixed base needed 160 to 920, more for more effects. The
number for floating bases, where more effects are tried, is a guess."""


def expected_seconds(
    plant: Plant,
    traces: Sequence[Trace],
    reference: Sequence[Trace],
    channels: Channels,
    threads: int,
) -> float:
    """Estimated duration of a diagnosis [s], right within a factor of two or three.

    One batch is simulated and timed: every kind of effect once, at its first place. On
    a fixed base a search in the recordings of the healthy robot (`reference`) precedes
    that in `traces` and takes as long.
    """
    fit = affordable(plant, split(traces)).fit
    predictor = Predictor(plant, fit, channels, threads=threads)
    models: list[Model] = []
    for name, kind in all_effects().items():
        for place in kind.places(plant, predictor.traces)[:1]:
            values = tuple(one.typical for one in kind.parameters(plant, place))
            models.append((PlacedEffect(name, place, values),))
    begun_s = time.monotonic()
    predictor.predict(models)
    each_s = (time.monotonic() - begun_s) / len(models)
    searches = 2 if reference and plant.base == "fixed" else 1
    return searches * REPLAYS[plant.base] * each_s
