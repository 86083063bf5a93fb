"""Effects that share their values, since joints have the same motors (ties)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from diagnosis.effects.library import effect
from diagnosis.effects.parts import PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.replays import Model

Level = Literal["all", "motor", "each"]
"""How widely joints share values: all of them, those with the same motor, or none."""


def group_of(placed: PlacedEffect) -> tuple[str, str]:
    """What effects that share their values have in common, and no others have."""
    return (placed.name, placed.tied) if placed.tied else (placed.key, "")


def groups_of(model: Model) -> list[Model]:
    """The effects of a model; those that share their values are together."""
    found: dict[tuple[str, str], list[PlacedEffect]] = {}
    for placed in model:
        found.setdefault(group_of(placed), []).append(placed)
    return [tuple(one) for one in found.values()]


def is_everywhere(places: int, joints: int) -> bool:
    """Whether a kind of effect at so many places is at half of all joints or more."""
    return places >= max(joints / 2, 2)


def kinds_of(model: Model, joints: int) -> list[Model]:
    """The effects of a model; those of a kind that is everywhere are together.

    Others are together if they share their values.
    """
    found = list[Model]()
    for name in dict.fromkeys(placed.name for placed in model):
        own = tuple(placed for placed in model if placed.name == name)
        found += [own] if is_everywhere(len(own), joints) else groups_of(own)
    return found


def without_each(model: Model) -> list[Model]:
    """The models that arise when each effect is removed in turn, tied ones together."""
    gone = [{placed.key for placed in group} for group in groups_of(model)]
    return [tuple(one for one in model if one.key not in keys) for keys in gone]


def number_of_values(model: Model) -> int:
    """Number of values of a model that are fitted; what is shared counts once."""
    return sum(len(group[0].values) for group in groups_of(model))


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


def labels(plant: Plant, level: Level) -> dict[str, str]:
    """For each joint a name of the joints that share their values with it."""
    if level == "motor":
        return motors(plant)
    turns_or_slides = {
        joint: "slides" if joint in plant.slides else "turns" for joint in plant.joints
    }
    return turns_or_slides if level == "all" else {one: one for one in plant.joints}


def tied(plant: Plant, effects: Sequence[PlacedEffect], level: Level) -> Model:
    """Effects of one kind at several joints, tied as widely as `level` says.

    What does not depend on the motor is never tied, nor are joints that slide with
    joints that turn. Tied effects get the mean of their values, and the first of their
    places as the label.
    """
    names, groups = labels(plant, level), dict[str, list[PlacedEffect]]()
    for placed in effects:
        shares = effect(placed.name).of_motor and placed.place in names
        group = names[placed.place] if shares else placed.place
        groups.setdefault(group, []).append(placed)
    found = []
    for own in groups.values():
        every = zip(*(one.values for one in own), strict=True)
        mean = tuple(sum(values) / len(values) for values in every)
        label = min(one.place for one in own) if len(own) > 1 else ""
        found += [replace(one, values=mean, tied=label) for one in own]
    return tuple(found)
