"""Effects of gears: play, and shafts that wind up."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.base_kinds import JointEffect, ServoEffect
from diagnosis.effects.parts import (
    EffectWords,
    JointMotion,
    Parameter,
    PlacedEffect,
    Values,
)
from diagnosis.effects.places import driven_joints
from diagnosis.effects.scales import inertia_kg_m2, torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

PLAY_RAD = 0.005
"""Servo error [rad] at which `Backlash.torque_column` takes a gear's play as 76 %
crossed. Small, since the sign of the error decides on which side the teeth touch."""

YIELD_RAD = 0.0005
"""By how much the teeth and shafts of a gear may yield under a large torque for its
joint: 1.7 arc minutes. An assumption; gears of arms wind up by about as much."""


class Backlash(ServoEffect):
    """A gap in the gear, within which no torque passes from motor to joint.

    The servo controls the motor's angle; the recorded encoder sits at the joint. Within
    the gap, whose size is the total play, the motor moves freely, slowed only by its
    damping; at the gap's edges it pushes the joint. Cheap gears have a gap of some
    hundredths of a radian.

    Source: Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model.
    """

    name = "backlash"
    shown_by = "reversals"
    native = False
    finer = 4  # within a step teeth touch or not, and light joints rattle
    words = EffectWords(
        "play (backlash)",
        "{joint} has play of {gap} {lacking}",
        "Gears with a gap between their teeth: after each reversal the motor turns "
        "before the joint follows.",
        "Tighten or replace the gear, or keep its teeth on one side by a constant "
        "load.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The gap [rad], the same for all robots and places."""
        return (Parameter("gap", "rad", 0.0, 0.15, 0.0, 0.02),)

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Widen the joint's gap in one variant; a second value is a compliance."""
        joints, at = copies.joints, (row, copies.column(place))
        joints.gap_rad[at] += values[0]
        joints.compliance_rad_nm[at] += values[1:].sum()

    def faintest(self, plant: Plant, place: str) -> float | None:
        """The gap [rad] by which gears without play may yield as well."""
        return YIELD_RAD

    def softer(self, plant: Plant, placed: PlacedEffect) -> PlacedEffect:
        """With a gear that yields beyond its gap; the compliance is in rad/(N m)."""
        compliance = YIELD_RAD / torque_nm(plant, placed.place)
        return replace(placed, values=(*placed.values, compliance))

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """A small and a large gap [rad]: the effect is not linear in its size."""
        return [(0.01,), (0.03,)]

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) servo torque lost for a gap of 1 rad: kp / 2 sign(command - q)."""
        error = motion.command_rad - motion.position_rad
        return np.asarray(motion.kp_nm_rad * np.tanh(error / PLAY_RAD) / 2)


class JointElasticity(JointEffect):
    """A spring from motor theta to link q: torque k (theta - q) + d (theta' - q').

    The joint's rotor inertia is on the motor's side, and so is the encoder. A joint
    that nothing drives has no motor.

    Source: Spong 1987, "Modeling and control of elastic joint robots", equations of
    motion with diagonal rotor inertia; damping beside the spring as in De Luca and
    Book 2016, "Robots with flexible elements".
    """

    name = "joint_elasticity"
    shown_by = "accelerations"
    native = False
    stiff = True
    finer = 2  # its motor oscillates too fast for whole steps
    joint_by_joint = False
    on_every_servo = False
    main_parameters = ("stiffness",)
    words = EffectWords(
        "elastic joint",
        "{joint} is elastic between motor and link, with a stiffness of {stiffness} "
        "and a damping of {damping}, {lacking}",
        "A gear or shaft that winds up like a spring, so that the link lags behind its "
        "motor and rings.",
        "Look for a loose horn, coupling or belt, and for a link that bends.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints that a servo or a torque drives."""
        return driven_joints(plant, traces)

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Stiffness k [N m/rad] and damping d [N m s/rad].

        A typical spring twists by 0.05 rad under a large torque for the joint, and has
        3 % of critical damping; at the bounds it twists by 1 rad and by 0.5 mrad.
        """
        scale = torque_nm(plant, place)
        typical, high = scale / 0.05, scale / YIELD_RAD
        critical = 2 * float(np.sqrt(typical * inertia_kg_m2(plant, place)))
        return (
            Parameter("stiffness", "N m/rad", scale, high, np.inf, typical, True),
            Parameter("damping", "N m s/rad", 0.0, critical, 0.0, 0.03 * critical),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Put the spring in series with any other at the joint: compliances add.

        With s the Laplace variable, springs k_i + d_i s in series give
        1 / sum 1/(k_i + d_i s), to first order in s a damping d = k^2 sum d_i / k_i^2.
        """
        stiffness, damping = values
        if np.isinf(stiffness):
            return
        joints, at = copies.joints, (row, copies.column(place))
        before = joints.spring_nm_rad[at]
        total = 1 / (1 / before + 1 / stiffness)
        joints.spring_damping_nm_s_rad[at] *= (total / before) ** 2
        joints.spring_damping_nm_s_rad[at] += damping * (total / stiffness) ** 2
        joints.spring_nm_rad[at] = total

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """A soft and a stiff spring: the effect is not linear in its size."""
        stiffness, damping = (one.typical for one in self.parameters(plant, place))
        return [(stiffness * k, damping * k) for k in (1.0, 5.0)]
