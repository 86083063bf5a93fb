"""The ground of a robot model: its geoms, and effects of its slope and of bumps."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from diagnosis.effects.bases import NumberEffect
from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Base, Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError


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


class GroundSlope(Effect):
    """The ground, or a fixed base, is rotated by R = R_y(pitch) R_x(roll).

    With positive pitch the ground falls towards +x, with positive roll it rises towards
    +y. For a floating base the ground's geoms rotate about the world's origin. For a
    fixed base gravity g rotates instead: it becomes R^T g in the base's frame.

    Source: elementary rotations, Craig 2005, "Introduction to robotics", chapter 2. In
    MuJoCo `geom_quat` and `geom_pos`, or `opt.gravity`.
    """

    name = "ground_slope"
    place_kind = "world"
    native = True
    components = 2
    by_inverse_dynamics = True
    words = EffectWords(
        "tilt",
        "the ground, or the mounting of the base, is tilted by {pitch} in pitch and "
        "{roll} in roll",
        "Gravity does not point where the model has it.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("world",) if the base is fixed or the model has a ground, else ()."""
        has_any = plant.base == "fixed" or len(ground_geoms(plant)) > 0
        return ("world",) if has_any else ()

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The parameters pitch and roll [rad] of the tilt."""
        return tuple(
            Parameter(name, "rad", -0.3, 0.3, 0.0, 0.03) for name in ("pitch", "roll")
        )

    def apply(
        self, variants: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Rotate a variant's ground, or its gravity if the base is fixed."""
        if not np.any(values):
            return
        if variants.plant.base == "fixed":
            self.apply_to_sim(variants, row, place, values)
            return
        tilt = _tilt(*values)
        places, turns = variants.field("geom_pos"), variants.field("geom_quat")
        for geom in ground_geoms(variants.plant):
            places[row, geom] = _call("mju_rotVecQuat", 3, places[row, geom], tilt)
            turns[row, geom] = _call("mju_mulQuat", 4, tilt, turns[row, geom])

    def apply_to_sim(
        self, variants: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Rotate gravity instead of the ground, so that heightfields stay in place."""
        gravity = variants.field("opt.gravity")
        back = _call("mju_negQuat", 4, _tilt(*values))
        gravity[row] = _call("mju_rotVecQuat", 3, gravity[row], back)

    def obstacle(self, recorded: Base, base: Base) -> str:
        """Why a floating base cannot have the tilt of a fixed one's mount, or ""."""
        if recorded != "fixed" or base != "floating":
            return ""
        return (
            "ground_slope is how a fixed base was mounted: a floating robot "
            "cannot have it"
        )


class UnevenGround(NumberEffect):
    """Bumps: heights of the ground spread about the plane, 99 % within +-height.

    Where the bumps are cannot be known. A simulation that starts in the middle of a
    recording takes the ground to be where the recorded soles stood at its start, within
    +-height of the plane (`diagnosis.replay.conforming_ground`). So the height found is
    about that of the largest bump stepped on, bumps below 0.6 mm are not seen, and the
    ground is flat where a foot steps later. 1 mm is tried first, less than most real
    bumps.

    Source: ground profiles as random processes, ISO 8608:2016.
    """

    name = "uneven_ground"
    place_kind = "world"
    native = False
    rarity_nats = 10.0
    """Extra log-likelihood [nats] that the effect needs to be accepted: it fits the
    ground to every stand of a sole, which is like one more parameter for each."""
    quantity = "bump_height_m"
    usual = (Parameter("height", "m", 0.0, 0.03, 0.0, 0.001),)
    words = EffectWords(
        "uneven ground",
        "the ground has bumps of {height} {lacking}",
        "The feet meet the ground earlier or later than on a plane.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("world",) if the robot can walk on a ground, else ()."""
        return ("world",) if has_ground_contact(plant) else ()

    def apply_to_sim(
        self, variants: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Refuse the effect, because it is not known where the bumps are.

        Raises:
          BadModelError: always.
        """
        raise BadModelError(
            "uneven_ground says how high bumps are, not where: give the sim a "
            "terrain with bumps instead"
        )


def _tilt(pitch_rad: float, roll_rad: float) -> FloatArray:
    """Quaternion (4,) w, x, y, z of the rotation R_y(pitch) R_x(roll)."""
    pitch = np.array([np.cos(pitch_rad / 2), 0, np.sin(pitch_rad / 2), 0])
    roll = np.array([np.cos(roll_rad / 2), np.sin(roll_rad / 2), 0, 0])
    return _call("mju_mulQuat", 4, pitch, roll)


def _call(function: str, size: int, *arguments: Any) -> FloatArray:
    """Call a function of MuJoCo by name; return the array (size,) that it writes."""
    result = np.zeros(size)
    getattr(mujoco, function)(result, *arguments)
    return result
