"""An encoder that was mounted or calibrated wrongly."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class EncoderOffset(JointEffect):
    """Measured = true + offset, and the servo acts on what is measured.

    Source: joint offset of kinematic calibration, Hollerbach, Khalil and Gautier
    2016, "Model identification", Springer Handbook of Robotics.
    """

    name = "encoder_offset"
    native = False

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The offset."""
        return (Parameter("offset", "rad", -0.3, 0.3, 0.0, 0.03),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Offsets add."""
        variants.joints.offset_rad[row, variants.column(place)] += values[0]
