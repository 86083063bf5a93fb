"""Friction that grows with speed."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import brisk_rad_s, torque_nm
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class ViscousFriction(JointEffect):
    """Torque -b v against a joint's speed v, as of an oil film.

    Source: the linear part of the static friction map in Armstrong-Helouvry, Dupont
    and Canudas de Wit 1994, "A survey of models, analysis tools and compensation
    methods for the control of machines with friction". In MuJoCo `dof_damping`.
    """

    name = "viscous_friction"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """b; a typical one costs a tenth of the torque range at a brisk speed."""
        scale = torque_nm(plant, place) / brisk_rad_s(plant, place)
        return (Parameter("coefficient", "N m s/rad", 0.0, scale, 0.0, 0.1 * scale),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Coefficients add."""
        variants.field("dof_damping")[row, variants.dof(place)] += values[0]
