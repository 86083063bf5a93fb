"""Friction of a gear that grows with what the gear carries."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class LoadFriction(JointEffect):
    """Torque -s |tau| sign(v), with tau the servo's torque, its back-EMF included.

    Source: Dohring, Lee and Newman 1993, "A load-dependent transmission friction
    model"; the same form as in Duclusaud, Passault, Padois and Ly 2024, "Extended
    friction models for the physics simulation of servo actuators".
    """

    name = "load_friction"
    native = False

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The share s; above 1 no motor could turn its gear."""
        return (Parameter("share", "1", 0.0, 0.8, 0.0, 0.1),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Shares add."""
        variants.joints.load_share[row, variants.column(place)] += values[0]
