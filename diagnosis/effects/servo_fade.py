"""A servo that weakens while it warms up or its battery empties."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import ServoEffect
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class ServoFade(ServoEffect):
    """Stiffness kp (1 - rate t), with t since the start of the trace.

    Source: to first order what a falling supply voltage or a warming winding and
    magnet do to a motor's constant, Hughes and Drury 2019, "Electric motors and
    drives", chapter 3.
    """

    name = "servo_fade"
    native = False

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The rate: 3 to 30 % over a run of 10 to 60 s."""
        return (Parameter("rate", "1/s", 0.0, 0.05, 0.0, 0.005),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Rates add."""
        variants.joints.fade_1_s[row, variants.column(place)] += values[0]
