"""Replays for baselines: time steps and references as a diagnosis has them."""

from collections.abc import Callable, Sequence

from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels, shared_channels
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.steps import with_best_steps
from diagnosis.search.reference import learn_reference
from diagnosis.traces.trace import Trace


def exact_replays(
    plant: Plant,
    traces: Sequence[Trace],
    reference: Sequence[Trace],
    explained: Callable[[Predictor], Model],
) -> Predictor:
    """Calibrated replays of recordings of a robot, in time steps as of a diagnosis.

    `reference` are recordings of the healthy robot, if any. On a fixed base the effects
    by which the baseline itself explains them (`explained`) are taken as given; the
    rest counts as noise.
    """
    channels = shared_channels(plant, [*traces, *reference])
    if not reference:
        return with_best_steps(Predictor(plant, traces, channels))
    known: Model = ()
    if plant.base == "fixed":
        known = explained(_alone(plant, reference, channels))
    noise = learn_reference(plant, reference, channels, known=known)
    return with_best_steps(Predictor(plant, traces, channels, noise=noise))


def _alone(plant: Plant, reference: Sequence[Trace], channels: Channels) -> Predictor:
    return with_best_steps(Predictor(plant, reference, channels))
