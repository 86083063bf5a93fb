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
    """The ground, or a fixed base, is rotated by R = R_y(pitch) R_x(roll).

    With positive pitch the ground falls towards +x, with positive roll it rises towards
    +y. For a floating base the ground's geoms rotate about the world's origin. For a
    fixed base gravity g rotates instead: it becomes R^T g in the base's frame.

    Source: elementary rotations, Craig 2005, "Introduction to robotics", chapter 2. In
    MuJoCo `geom_quat` and `geom_pos`, or `opt.gravity`.
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
        """("world",) if the base is fixed or the model has a ground, else ()."""
        has_any = plant.base == "fixed" or len(ground_geoms(plant)) > 0
        return ("world",) if has_any else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The parameters pitch and roll [rad] of the tilt."""
        return tuple(
            Parameter(name, "rad", -0.3, 0.3, 0.0, 0.03) for name in ("pitch", "roll")
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
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
            places[row, geom] = _turned(tilt, places[row, geom])
            turns[row, geom] = _product(tilt, turns[row, geom])

    def apply_to_sim(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Rotate gravity instead of the ground, so that heightfields stay in place."""
        gravity = variants.field("opt.gravity")
        gravity[row] = _turned(_inverse(_tilt(*values)), gravity[row])

    def obstacle(self, recorded: "Base", base: "Base") -> str:
        """Why a floating base cannot have the tilt of a fixed one's mount, or ""."""
        if recorded != "fixed" or base != "floating":
            return ""
        return (
            "ground_slope is how a fixed base was mounted: a floating robot "
            "cannot have it"
        )


def _tilt(pitch_rad: float, roll_rad: float) -> FloatArray:
    """Quaternion (4,) w, x, y, z of the rotation R_y(pitch) R_x(roll)."""
    pitch = np.array([np.cos(pitch_rad / 2), 0, np.sin(pitch_rad / 2), 0])
    roll = np.array([np.cos(roll_rad / 2), np.sin(roll_rad / 2), 0, 0])
    return _product(pitch, roll)


def _turned(turn: FloatArray, vector: FloatArray) -> FloatArray:
    """The vector (3,) rotated by a quaternion (4,)."""
    return _call("mju_rotVecQuat", 3, vector, turn)


def _product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Product of two quaternions (4,): the second rotation, followed by the first."""
    return _call("mju_mulQuat", 4, first, second)


def _inverse(turn: FloatArray) -> FloatArray:
    """Inverse of a unit quaternion (4,)."""
    return _call("mju_negQuat", 4, turn)


def _call(function: str, size: int, *arguments: Any) -> FloatArray:
    """Call a function of MuJoCo by name; return the array (size,) that it writes."""
    import mujoco

    result = np.zeros(size)
    getattr(mujoco, function)(result, *arguments)
    return result
