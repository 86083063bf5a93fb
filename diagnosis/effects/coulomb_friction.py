"""Friction that does not care how fast the joint moves."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import torque_nm
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class CoulombFriction(JointEffect):
    """Torque -tau sign(v), and up to tau against whatever drives a joint at rest.

    Source: dry friction after Coulomb 1785 as in Olsson, Astrom, Canudas de Wit,
    Gafvert and Lischinsky 1998, "Friction models and friction compensation",
    section 2. In MuJoCo `dof_frictionloss`.
    """

    name = "coulomb_friction"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Tau, up to half of the joint's torque range."""
        scale = torque_nm(plant, place)
        return (Parameter("torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Torques add."""
        variants.joints.coulomb_nm[row, variants.column(place)] += values[0]
