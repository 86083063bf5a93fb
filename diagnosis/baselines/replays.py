"""Replays for baselines: time steps and references as a diagnosis has them."""

from collections.abc import Callable, Sequence

from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import shared_channels
from diagnosis.residuals.doubted import no_nuisance
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.residuals.steps import with_best_steps
from diagnosis.search.reference import learn_reference
from diagnosis.traces.reference import Reference
from diagnosis.traces.trace import Trace


def exact_replays(
    plant: Plant,
    traces: Sequence[Trace],
    reference: Reference | None,
    explained: Callable[[Predictor], Model],
) -> Predictor:
    """Calibrated replays of recordings of a robot, in time steps as of a diagnosis.

    `reference` are recordings of the healthy robot, if any. On a fixed base the effects
    by which the baseline itself explains them (`explained`) are taken as given; the
    rest counts as noise.
    """
    healthy = reference.traces if reference else ()
    channels = shared_channels(plant, [*traces, *healthy])
    if reference is None:
        return _ready(Predictor(plant, traces, channels))
    known: Model = ()
    if plant.base == "fixed":
        known = explained(_ready(Predictor(reference.plant, healthy, channels)))
    noise = learn_reference(reference.plant, healthy, channels, known=known)
    return _ready(Predictor(plant, traces, channels, noise=noise))


def _ready(predictor: Predictor) -> Predictor:
    """The predictor in its best steps; usual errors of its model are no evidence."""
    some = with_best_steps(predictor)
    if some.plant.base == "fixed":
        some.doubt_beside(no_nuisance(some), ())
    return some
