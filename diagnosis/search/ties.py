"""Effects that share their values, since joints have the same motors (ties)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.predictor import Model

Level = Literal["all", "motor", "each"]
"""How widely joints share values: all of them, those with the same motor, or none."""


def units(model: Model) -> list[Model]:
    """The effects of a model; those that share their values are together."""
    found: dict[tuple[str, str], list[PlacedEffect]] = {}
    for placed in model:
        shared = (placed.name, placed.tied) if placed.tied else (placed.key, "")
        found.setdefault(shared, []).append(placed)
    return [tuple(one) for one in found.values()]


def without_each(model: Model) -> list[Model]:
    """The models that arise when each effect is removed in turn, tied ones together."""
    gone = [{placed.key for placed in unit} for unit in units(model)]
    return [tuple(one for one in model if one.key not in keys) for keys in gone]


def number_of_values(model: Model) -> int:
    """Number of values of a model that are fitted; what is shared counts once."""
    return sum(len(unit[0].values) for unit in units(model))


def motors(plant: Plant) -> dict[str, str]:
    """Each joint's kind of motor, named after the first joint that has it.

    Motors are alike if the model states the same torque limits, rotor inertia, damping
    and dry friction for their joints.
    """
    model, first, kinds = plant.model, dict[tuple[object, ...], str](), {}
    for column, (joint, dof) in enumerate(zip(plant.joints, plant.dofs, strict=True)):
        stated = (
            joint in plant.slides,
            float(plant.servo.max_torque_nm[column]),
            *map(float, model.jnt_actfrcrange[model.joint(joint).id]),
            float(model.dof_armature[dof]),
            float(model.dof_damping[dof]),
            float(model.dof_frictionloss[dof]),
        )
        kinds[joint] = first.setdefault(stated, joint)
    return kinds


def tied(plant: Plant, effects: Sequence[PlacedEffect], level: Level) -> Model:
    """Effects of one kind at several joints, tied as widely as `level` says.

    What does not depend on the motor is never tied, nor are joints that slide with
    joints that turn. Tied effects get the mean of their values, and the first of their
    places as the label.
    """
    kinds, groups = motors(plant), dict[str, list[PlacedEffect]]()
    for placed in effects:
        group = placed.key
        if level != "each" and effect(placed.name).of_motor:
            slides = "slides" if placed.place in plant.slides else "turns"
            group = slides if level == "all" else kinds[placed.place]
        groups.setdefault(group, []).append(placed)
    found = []
    for own in groups.values():
        every = zip(*(one.values for one in own), strict=True)
        mean = tuple(sum(values) / len(values) for values in every)
        label = min(one.place for one in own) if len(own) > 1 else ""
        found += [replace(one, values=mean, tied=label) for one in own]
    return tuple(found)
