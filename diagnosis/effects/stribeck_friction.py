"""Dry friction that is larger near standstill."""

from typing import TYPE_CHECKING

from diagnosis.effects._places import JointEffect
from diagnosis.effects._sizes import torque_nm
from diagnosis.effects.effect import Parameter, PlacedEffect
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant

GROWN_SPEEDS_RAD_S = (0.02, 0.07, 0.25)


class StribeckFriction(JointEffect):
    """Torque -(tau_c + tau_s exp(-(v / v_s)^2)) sign(v).

    Source: Armstrong-Helouvry, Dupont and Canudas de Wit 1994, "A survey of models,
    analysis tools and compensation methods for the control of machines with
    friction"; the square in the exponent is Tustin's form as changed by Bo and
    Pavelescu 1982.
    """

    name = "stribeck_friction"
    native = False

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Coulomb torque tau_c, extra torque tau_s and speed v_s."""
        scale = torque_nm(plant, place)
        return (
            Parameter("coulomb_torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),
            Parameter("extra_torque", "N m", 0.0, 0.5 * scale, 0.0, 0.04 * scale),
            Parameter("speed", "rad/s", 0.005, 2.0, 0.1, 0.1, logarithmic=True),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Torques add; speeds of two such effects are averaged by extra torque."""
        coulomb_nm, extra_nm, speed_rad_s = values
        joints, at = variants.joints, (row, variants.column(place))
        joints.coulomb_nm[at] += coulomb_nm
        if extra_nm > 0:
            total_nm = joints.stribeck_nm[at] + extra_nm
            share = extra_nm / total_nm
            joints.stribeck_speed_rad_s[at] *= 1 - share
            joints.stribeck_speed_rad_s[at] += share * speed_rad_s
            joints.stribeck_nm[at] = total_nm

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """With Coulomb friction it shares all but what happens near standstill."""
        if other.name != "coulomb_friction":
            return ()
        (torque_nm,) = other.values
        return tuple(
            PlacedEffect(
                self.name, other.place, (torque_nm, 0.5 * torque_nm, speed_rad_s)
            )
            for speed_rad_s in GROWN_SPEEDS_RAD_S
        )
