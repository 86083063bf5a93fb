"""The effect joint elasticity: a spring between motor and link."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects.bases import JointEffect
from diagnosis.effects.parts import EffectWords, Interval, Parameter, Values
from diagnosis.effects.scales import inertia_kg_m2, torque_nm
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.usage import Usage


class JointElasticity(JointEffect):
    """A spring from motor theta to link q: torque k (theta - q) + d (theta' - q').

    The joint's rotor inertia is on the motor's side, and so is the encoder.

    Source: Spong 1987, "Modeling and control of elastic joint robots", equations of
    motion with diagonal rotor inertia; damping beside the spring as in De Luca and
    Book 2016, "Robots with flexible elements".
    """

    name = "joint_elasticity"
    native = False
    stiff = True
    joint_by_joint = False
    on_every_servo = False
    main_parameters = ("stiffness",)
    words = EffectWords(
        "elastic joint",
        "{joint} is elastic between motor and link, with a stiffness of {stiffness} "
        "and a damping of {damping}, {lacking}",
        "A gear or shaft that winds up like a spring, so that the link lags behind its "
        "motor and rings.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Stiffness k [N m/rad] and damping d [N m s/rad].

        A typical spring twists by 0.05 rad under a large torque for the joint, and has
        3 % of critical damping; at the bounds it twists by 1 rad and by 0.5 mrad.
        """
        scale = torque_nm(plant, place)
        typical = scale / 0.05
        critical = 2 * float(np.sqrt(typical * inertia_kg_m2(plant, place)))
        return (
            Parameter(
                "stiffness", "N m/rad", scale, scale / 0.0005, np.inf, typical, True
            ),
            Parameter("damping", "N m s/rad", 0.0, critical, 0.0, 0.03 * critical),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Put the spring in series with any other at the joint: compliances add.

        With s the Laplace variable, springs k_i + d_i s in series give
        1 / sum 1/(k_i + d_i s), to first order in s a damping d = k^2 sum d_i / k_i^2.
        """
        stiffness, damping = values
        if np.isinf(stiffness):
            return
        joints, at = variants.joints, (row, variants.column(place))
        before = joints.spring_nm_rad[at]
        total = 1 / (1 / before + 1 / stiffness)
        joints.spring_damping_nm_s_rad[at] *= (total / before) ** 2
        joints.spring_damping_nm_s_rad[at] += damping * (total / stiffness) ** 2
        joints.spring_nm_rad[at] = total

    def first_tries(
        self,
        plant: "Plant",
        place: str,
        usage: "Usage",
        intervals: Sequence[Interval],
    ) -> list[Values]:
        """A soft and a stiff spring: the effect is not linear in its size."""
        stiffness, damping = (one.typical for one in self.parameters(plant, place))
        return [(stiffness * k, damping * k) for k in (1.0, 5.0)]
