"""Water, air or a hand that slows a body down."""

from typing import TYPE_CHECKING

from diagnosis.effect import Parameter
from diagnosis.effects._places import BodyEffect
from diagnosis.effects._sizes import weight_n
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.plant import Plant
    from diagnosis.variants import Variants


class Drag(BodyEffect):
    """Force -c v at a body's centre of mass, v its velocity in the world.

    Source: drag at low speed, linear as Stokes 1851 found for a sphere.
    """

    name = "drag"
    native = False

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """c; a typical one holds back a tenth of the robot's weight at 1 m/s."""
        scale = weight_n(plant)
        return (Parameter("coefficient", "N s/m", 0.0, 2 * scale, 0.0, 0.1 * scale),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Coefficients add."""
        variants.outside.drag_n_s_m[row, variants.body(place)] += values[0]
