"""A hard stop inside of a joint's nominal range."""

from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import range_rad
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant

_FAR_RAD = 1e6
_STIFF = (0.005, 1.0)


class EndStop(JointEffect):
    """A unilateral constraint: q <= angle (side +1) or q >= angle (side -1).

    The stop pushes the joint back, critically damped, with a time constant of 5 ms;
    MuJoCo raises it to two steps where these are longer.

    Source: complementarity between distance and force, Brogliato 2016, "Nonsmooth
    mechanics". In MuJoCo `jnt_range`.
    """

    name = "end_stop"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Angle and side; only the sign of the side counts."""
        low, high = range_rad(plant, place)
        is_limited = plant.model.jnt_limited[plant.model.joint(place).id]
        neutral = high if is_limited else np.inf
        typical = low + 0.75 * (high - low)
        return (
            Parameter("angle", "rad", low, high, neutral, typical),
            Parameter("side", "1", -1.0, 1.0, 1.0, 1.0),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """The nearer stop counts; one outside of the range changes nothing."""
        angle, side = (float(value) for value in values)
        joint = variants.plant.model.joint(place).id
        limited, ranges = variants.field("jnt_limited"), variants.field("jnt_range")
        low, high = ranges[row, joint] if limited[row, joint] else (-_FAR_RAD, _FAR_RAD)
        if not low < angle < high:
            return
        ranges[row, joint] = (low, angle) if side > 0 else (angle, high)
        limited[row, joint] = 1
        variants.field("jnt_solref")[row, joint] = _STIFF
