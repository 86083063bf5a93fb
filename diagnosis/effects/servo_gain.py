"""A servo that is softer or stiffer than the model says."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import ServoEffect
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class ServoGain(ServoEffect):
    """Torque = factor kp (command - q) - ...

    Source: proportional part of a position loop, Spong, Hutchinson and Vidyasagar
    2006, "Robot modeling and control", chapter 6. In MuJoCo `actuator_gainprm` and
    `actuator_biasprm`.
    """

    name = "servo_gain"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The factor."""
        return (Parameter("factor", "1", 0.1, 5.0, 1.0, 0.8, logarithmic=True),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Factors multiply."""
        variants.joints.kp_factor[row, variants.column(place)] *= values[0]
