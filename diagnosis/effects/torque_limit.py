"""A motor that is weaker than the model says."""

from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import torque_nm
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class TorqueLimit(JointEffect):
    """Torque = clip(demand, -limit, limit), besides the servo's own limit.

    Source: actuator saturation, Spong, Hutchinson and Vidyasagar 2006, "Robot modeling
    and control", chapter 6. In MuJoCo `actuator_forcerange`.
    """

    name = "torque_limit"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The limit; where the servo has one, larger limits do nothing."""
        scale = torque_nm(plant, place)
        own = float(plant.servo.max_torque_nm[plant.joints.index(place)])
        high = scale if np.isfinite(own) else 5 * scale
        return (
            Parameter("torque", "N m", 0.02 * scale, high, np.inf, 0.6 * scale, True),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """The lower limit counts."""
        limits, at = variants.joints.max_torque_nm, (row, variants.column(place))
        limits[at] = min(limits[at], values[0])
