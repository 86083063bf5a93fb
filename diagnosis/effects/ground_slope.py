"""An effect: the ground is not level, or a fixed base is mounted tilted."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from diagnosis.effects.effect import Effect
from diagnosis.effects.ground import ground_geoms
from diagnosis.effects.parts import EffectWords, Parameter, PlaceKind
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Base, Plant
    from diagnosis.traces.trace import Trace


class GroundSlope(Effect):
    """The ground, or a fixed base, is turned by R = R_y(pitch) R_x(roll).

    A positive pitch lets the ground fall towards +x, a positive roll lets it rise
    towards +y. For a floating base the ground's geoms turn about the world's origin.
    A fixed base stays where it is and gravity turns: R^T g, as the base sees it.

    Source: elementary rotations, Craig 2005, "Introduction to robotics", chapter 2. In
    MuJoCo `geom_quat` and `geom_pos`, or `opt.gravity`; constants that follow from
    them are `mj_setConst`'s.
    """

    name = "ground_slope"
    place_kind: ClassVar[PlaceKind] = "world"
    native = True
    components = 2
    by_inverse_dynamics = True
    words = EffectWords(
        "tilt",
        "the ground, or the mounting of the base, is tilted by {pitch} in pitch and "
        "{roll} in roll",
        "Gravity does not point where the model has it.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """The world, if the base is fixed or there is a ground."""
        has_any = plant.base == "fixed" or len(ground_geoms(plant)) > 0
        return ("world",) if has_any else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Pitch and roll."""
        return tuple(
            Parameter(name, "rad", -0.3, 0.3, 0.0, 0.03) for name in ("pitch", "roll")
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Turn the ground, or gravity if the base is fixed."""
        if not np.any(values):
            return
        if variants.plant.base == "fixed":
            self.apply_to_sim(variants, row, place, values)
            return
        tilt = _tilt(*values)
        places, turns = variants.field("geom_pos"), variants.field("geom_quat")
        for geom in ground_geoms(variants.plant):
            places[row, geom] = _turned(tilt, places[row, geom])
            turns[row, geom] = _product(tilt, turns[row, geom])

    def apply_to_sim(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Turn gravity instead of the ground, so that a terrain stays where it is."""
        gravity = variants.field("opt.gravity")
        gravity[row] = _turned(_inverse(_tilt(*values)), gravity[row])

    def obstacle(self, recorded: "Base", base: "Base") -> str:
        """Why the tilt of a fixed base cannot be the slope that a robot walks on."""
        if recorded != "fixed" or base != "floating":
            return ""
        return (
            "ground_slope is how a fixed base was mounted: a floating robot "
            "cannot have it"
        )


def _tilt(pitch_rad: float, roll_rad: float) -> FloatArray:
    """Quaternion of R_y(pitch) R_x(roll)."""
    pitch = np.array([np.cos(pitch_rad / 2), 0, np.sin(pitch_rad / 2), 0])
    roll = np.array([np.cos(roll_rad / 2), np.sin(roll_rad / 2), 0, 0])
    return _product(pitch, roll)


def _turned(turn: FloatArray, vector: FloatArray) -> FloatArray:
    """The vector (3,) turned by a quaternion."""
    return _call("mju_rotVecQuat", 3, vector, turn)


def _product(first: FloatArray, second: FloatArray) -> FloatArray:
    """The product of two quaternions: the second turn, then the first."""
    return _call("mju_mulQuat", 4, first, second)


def _inverse(turn: FloatArray) -> FloatArray:
    """The inverse of a quaternion."""
    return _call("mju_negQuat", 4, turn)


def _call(function: str, size: int, *arguments: Any) -> FloatArray:
    """Call one of MuJoCo's functions and return the array (size,) that it writes."""
    import mujoco

    result = np.zeros(size)
    getattr(mujoco, function)(result, *arguments)
    return result
