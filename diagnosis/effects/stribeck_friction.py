"""The effect Stribeck friction: dry friction that is larger near standstill."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects.bases import JointEffect
from diagnosis.effects.parts import (
    EffectWords,
    Interval,
    JointMotion,
    Parameter,
    PlacedEffect,
    Values,
)
from diagnosis.effects.scales import torque_nm
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.usage import Usage

GROWN_SPEEDS_RAD_S = (0.02, 0.07, 0.25)
"""Stribeck speeds v_s that are tried once plain dry friction was found to help: below
v_s friction is larger."""

COLUMN_SPEED_RAD_S = 0.1
"""Stribeck speed v_s assumed in sparse regression, where friction is not linear in v_s
so that it cannot be fitted."""


class StribeckFriction(JointEffect):
    """Dry friction with a peak: torque -(tau_c + tau_s exp(-(v / v_s)^2)) sign(v).

    Source: Armstrong-Helouvry, Dupont and Canudas de Wit 1994, "A survey of models,
    analysis tools and compensation methods for the control of machines with
    friction"; the square in the exponent is Tustin's form as changed by Bo and
    Pavelescu 1982.
    """

    name = "stribeck_friction"
    native = False
    column_parameter = 1
    main_parameters = ("coulomb_torque", "extra_torque")
    words = EffectWords(
        "dry friction that sticks (Stribeck)",
        "{joint} has dry friction of {coulomb_torque}, and {extra_torque} more below "
        "{speed}, {lacking}",
        "Dry friction that is larger near standstill than in motion, so that slow "
        "movements stick and slip.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Coulomb torque tau_c and extra torque tau_s [N m], and speed v_s [rad/s]."""
        scale = torque_nm(plant, place)
        return (
            Parameter("coulomb_torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),
            Parameter("extra_torque", "N m", 0.0, 0.5 * scale, 0.0, 0.04 * scale),
            Parameter("speed", "rad/s", 0.005, 2.0, 0.1, 0.1, logarithmic=True),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the torques to a variant's; speeds v_s are averaged by extra torque."""
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
        """Start values from plain dry friction: half as much torque again at rest."""
        if other.name != "coulomb_friction":
            return ()
        (torque_nm,) = other.values
        return tuple(
            PlacedEffect(
                self.name, other.place, (torque_nm, 0.5 * torque_nm, speed_rad_s)
            )
            for speed_rad_s in GROWN_SPEEDS_RAD_S
        )

    def first_tries(
        self,
        plant: "Plant",
        place: str,
        usage: "Usage",
        intervals: Sequence[Interval],
    ) -> list[Values]:
        """Values with two different speeds v_s: the effect is not linear in v_s."""
        coulomb, extra, _ = (one.typical for one in self.parameters(plant, place))
        return [(coulomb, extra, speed) for speed in (0.03, 0.2)]

    def simpler(self, placed: PlacedEffect) -> PlacedEffect:
        """Plain dry friction, halfway between the torques at high speed and at rest."""
        coulomb_nm, extra_nm, _ = placed.values
        mean_nm = coulomb_nm + extra_nm / 2
        return PlacedEffect("coulomb_friction", placed.place, (mean_nm,))

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) friction near standstill for tau_s = 1 N m, along the velocity."""
        slow = np.exp(-((motion.velocity_rad_s / COLUMN_SPEED_RAD_S) ** 2))
        return np.asarray(slow * motion.direction)
