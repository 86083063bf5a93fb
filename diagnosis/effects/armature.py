"""Inertia of a motor's rotor, as the joint feels it through the gear."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import inertia_kg_m2
from diagnosis.effects.effect import Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class Armature(JointEffect):
    """Torque -J a against a joint's acceleration a; J = (gear ratio)^2 rotor inertia.

    Source: gears in Featherstone 2008, "Rigid body dynamics algorithms", section 9.6.
    In MuJoCo `dof_armature`.
    """

    name = "armature"
    native = True

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """J, beside what the plant has already."""
        scale = inertia_kg_m2(plant, place)
        return (Parameter("inertia", "kg m^2", 0.0, 10 * scale, 0.0, 0.5 * scale),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Inertias add."""
        variants.field("dof_armature")[row, variants.dof(place)] += values[0]
