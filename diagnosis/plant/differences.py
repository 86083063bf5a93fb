"""Tells in which quantities two models of one robot differ."""

from collections.abc import Sequence

import numpy as np

from diagnosis.plant.plant import Plant
from groundwalk.arrays import FloatArray

SAME = 1e-6
"""Largest difference, as a share, of numbers that text files give with other digits."""

_OF_JOINTS = {
    "dof_armature": "rotor inertia (armature)",
    "dof_damping": "damping",
    "dof_frictionloss": "dry friction",
}
_OF_BODIES = {
    "body_mass": "mass",
    "body_inertia": "inertia",
    "body_ipos": "centre of mass",
}


def differences(plant: Plant, other: Plant) -> tuple[str, ...]:
    """In what two models differ, such as "rotor inertia (armature) at 5 joints".

    Joints, and bodies that have mass and move, are compared by name. Numbers are equal
    that differ by less than a millionth of the larger one.

    Example:
      >>> differences(load_plant("so101", "fixed"), load_plant("a.urdf", "fixed"))
      ('rotor inertia (armature) at 5 joints',)
    """
    joints = [name for name in plant.joints if name in other.joints]
    bodies = [name for name in plant.bodies if name in other.bodies]
    told = [
        *_alone("joint", plant.joints, other.joints),
        *_alone("body", plant.bodies, other.bodies),
    ]
    for field, words in _OF_JOINTS.items():
        ours, theirs = (_at_joints(one, field, joints) for one in (plant, other))
        told += _told(words, ("joint", "joints"), ours, theirs)
    for field, words in _OF_BODIES.items():
        ours, theirs = (_at_bodies(one, field, bodies) for one in (plant, other))
        told += _told(words, ("body", "bodies"), ours, theirs)
    return tuple(told)


def _alone(kind: str, ours: Sequence[str], theirs: Sequence[str]) -> list[str]:
    """The first name that only one of the models has."""
    alone = sorted({*ours} ^ {*theirs})
    return [f"{kind} {name!r}, which only one has" for name in alone[:1]]


def _at_joints(plant: Plant, field: str, joints: Sequence[str]) -> FloatArray:
    """(n, 1) numbers of a field of `MjModel` at joints of these names."""
    dofs = [plant.dofs[plant.joints.index(name)] for name in joints]
    return np.asarray(getattr(plant.model, field)[dofs]).reshape(len(joints), -1)


def _at_bodies(plant: Plant, field: str, bodies: Sequence[str]) -> FloatArray:
    """(n, d) numbers of a field of `MjModel` of bodies of these names."""
    rows = [int(plant.model.body(name).id) for name in bodies]
    return np.asarray(getattr(plant.model, field)[rows]).reshape(len(bodies), -1)


def _told(
    words: str, places: tuple[str, str], ours: FloatArray, theirs: FloatArray
) -> list[str]:
    """At how many places rows of numbers (n, d) differ; [] if they are equal."""
    larger = np.maximum(np.abs(ours), np.abs(theirs)).max(axis=1, initial=0.0)
    count = int((np.abs(ours - theirs).max(axis=1, initial=0.0) > SAME * larger).sum())
    return [f"{words} at {count} {places[count > 1]}"] if count else []
