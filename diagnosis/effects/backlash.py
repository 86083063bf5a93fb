"""Play of a gear."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import ServoEffect
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class Backlash(ServoEffect):
    """No torque reaches the joint while motor and joint are within the gap.

    The servo closes its loop on the motor's side; the encoder that is recorded sits at
    the joint. Within the gap the motor follows its command alone, braked by its
    damping; at the gap's edges it pushes the joint. Gap is the total play. The motion
    is that of `diagnosis.replay.gaps`.

    Source: Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model.
    """

    name = "backlash"
    native = False

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The gap: cheap gears have some hundredths of a radian."""
        return (Parameter("gap", "rad", 0.0, 0.15, 0.0, 0.02),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """The play of one stage adds to the next one's."""
        variants.joints.gap_rad[row, variants.column(place)] += values[0]
