"""Finds the geoms of ground and soles in a robot model, and their friction."""

import numpy as np

from diagnosis.plant.plant import Plant
from groundwalk.arrays import IntArray


def ground_geoms(plant: Plant) -> IntArray:
    """(k,) MuJoCo ids of the geoms on the world body that can collide: the ground."""
    model = plant.model
    can_touch = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    return np.flatnonzero((model.geom_bodyid == 0) & can_touch)


def foot_geoms(plant: Plant, foot: str) -> IntArray:
    """(k,) MuJoCo ids of a foot's geoms that can collide with the ground."""
    model = plant.model
    of_foot: IntArray = np.flatnonzero(model.geom_bodyid == model.body(foot).id)
    ground = ground_geoms(plant)
    type_foot, like_foot = model.geom_contype[of_foot], model.geom_conaffinity[of_foot]
    meets = (type_foot[:, None] & model.geom_conaffinity[ground]) | (
        like_foot[:, None] & model.geom_contype[ground]
    )
    touching: IntArray = of_foot[(meets != 0).any(axis=1)]
    return touching


def sole_geoms(plant: Plant) -> IntArray:
    """(k,) MuJoCo ids of the geoms of all feet that can collide with the ground."""
    none = np.zeros(0, np.intp)
    return np.concatenate([none, *(foot_geoms(plant, foot) for foot in plant.feet)])


def has_ground_contact(plant: Plant) -> bool:
    """Whether the base floats and the robot has feet that can touch a ground."""
    return plant.base == "floating" and len(sole_geoms(plant)) > 0


def sole_friction(plant: Plant) -> float:
    """Sliding friction coefficient of the feet on the ground; 0 if they cannot touch.

    MuJoCo uses the coefficient of the geom with the higher priority, and the larger one
    if priorities are equal (its documentation, "Contact parameters").
    """
    model, ground, soles = plant.model, ground_geoms(plant), sole_geoms(plant)
    if not len(soles):
        return 0.0
    sole, floor = int(soles[0]), int(ground[0])
    friction = model.geom_friction[[sole, floor], 0]
    priority = model.geom_priority[[sole, floor]]
    if priority[0] == priority[1]:
        return float(friction.max())
    return float(friction[np.argmax(priority)])
