"""What has changed of a real robot, by the torques of its healthy recordings."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.residuals.replays import Model
from diagnosis.residuals.torques.healthy_torques import HealthyTorques
from diagnosis.residuals.torques.torque_predictor import TorquePredictor
from diagnosis.search.reference import MOST_S
from diagnosis.traces.split import shortened
from diagnosis.traces.trace import Trace


def learn_torques(
    before: Plant,
    reference: Sequence[Trace],
    other: tuple[Plant, Sequence[Trace]],
    channels: Channels,
    model: Model | None = (),
) -> ReferenceNoise:
    """Learn the torque errors of the healthy robot, as its recordings show them.

    `before` is the model of the healthy robot, `other` the model and the recordings to
    be diagnosed: how much recordings differ is learned of what the effects of `model`
    leave of these as well, for None of the healthy robot only. All traces have a
    `motion`.
    """
    sets: list[tuple[Plant, Sequence[Trace], Model]] = [(before, reference, ())]
    if model is not None:
        sets.append((*other, model))
    found = [
        TorquePredictor(plant, shortened(traces, MOST_S), channels).means(effects)
        for plant, traces, effects in sets
    ]
    known = ReferenceNoise.known((), len(channels.names))
    return replace(known, healthy=HealthyTorques.of(*found))


def established_changes(
    before: Plant,
    reference: Sequence[Trace],
    other: tuple[Plant, Sequence[Trace]],
    channels: Channels,
    model: Model,
    least: Callable[[Model], float],
) -> Model:
    """The effects of a model without which recordings are much less likely.

    Each alternative may have its own differences between recordings: what these can
    be explains an effect away if it makes them as likely. Arguments are those of
    `learn_torques`; `least` is what a model of one effect must gain [nats].
    """

    def evidence(some: Model) -> float:
        found = learn_torques(before, reference, other, channels, some).healthy
        assert found is not None
        return found.evidence

    while model:
        whole = evidence(model)
        rest = [model[:i] + model[i + 1 :] for i in range(len(model))]
        spare = [
            whole - evidence(without) - least((one,))
            for one, without in zip(model, rest, strict=True)
        ]
        worst = int(np.argmin(spare))
        if spare[worst] > 0:
            break
        model = rest[worst]
    return model
