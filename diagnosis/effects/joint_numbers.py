"""Effects that change one number of a joint: friction, rotor inertia, gap, encoder."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.effects.bases import JointNumber, ServoNumber
from diagnosis.effects.parts import (
    EffectWords,
    Interval,
    JointMotion,
    Parameter,
    PlacedEffect,
    Values,
)
from diagnosis.effects.scales import brisk_rad_s, inertia_kg_m2, torque_nm
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.usage import Usage

PLAY_RAD = 0.005
"""Servo error [rad] at which `Backlash.torque_column` takes a gear's play as 76 %
crossed. Small, since the sign of the error decides on which side the teeth touch."""


class ViscousFriction(JointNumber):
    """Torque -b v against a joint's speed v, as of an oil film.

    Source: the linear part of the static friction map in Armstrong-Helouvry, Dupont
    and Canudas de Wit 1994, "A survey of models, analysis tools and compensation
    methods for the control of machines with friction". In MuJoCo `dof_damping`.
    """

    name = "viscous_friction"
    native = True
    array = "dof_damping"
    words = EffectWords(
        "viscous friction",
        "{joint} has viscous friction of {coefficient} {lacking}",
        "A torque against the motion that grows with speed, as in thick grease.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The coefficient b [N m s/rad]; typical: 10 % of full torque in brisk use."""
        scale = torque_nm(plant, place) / brisk_rad_s(plant, place)
        return (Parameter("coefficient", "N m s/rad", 0.0, scale, 0.0, 0.1 * scale),)

    def twins(self, plant: "Plant", place: str) -> tuple[PlacedEffect, ...]:
        """Larger servo damping, if the motor has back-EMF: the torque is the same."""
        if place not in plant.joints:
            return ()
        has_emf = plant.servo.back_emf_nm_s_rad[plant.joints.index(place)] > 0
        return (PlacedEffect("servo_damping", place),) if has_emf else ()

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) joint velocity: the torque of a coefficient of 1 N m s/rad."""
        return motion.velocity_rad_s

    def from_column(
        self, size: float, error: float, damping_nm_s_rad: float
    ) -> tuple[str, float, float]:
        """Name, value, error; a negative coefficient becomes weaker servo damping."""
        if size >= 0 or damping_nm_s_rad <= 0:
            return self.name, size, error
        share = 1 / damping_nm_s_rad
        return "servo_damping", 1 + size * share, error * share


class CoulombFriction(JointNumber):
    """Torque -tau sign(v), and up to tau against whatever drives a joint at rest.

    Source: dry friction after Coulomb 1785 as in Olsson, Astrom, Canudas de Wit,
    Gafvert and Lischinsky 1998, "Friction models and friction compensation",
    section 2. In MuJoCo `dof_frictionloss`.
    """

    name = "coulomb_friction"
    native = True
    array = "coulomb_nm"
    words = EffectWords(
        "dry friction",
        "{joint} has dry friction of {torque} {lacking}",
        "A torque against the motion that is the same at all speeds; at rest it holds "
        "the joint until something stronger pulls.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The torque tau [N m], at most half of a large torque for the joint."""
        scale = torque_nm(plant, place)
        return (Parameter("torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) smooth sign of the velocity: the torque of dry friction of 1 N m."""
        return motion.direction


class LoadFriction(JointNumber):
    """Torque -s |tau| sign(v), with tau the servo's torque, its back-EMF included.

    Source: Dohring, Lee and Newman 1993, "A load-dependent transmission friction
    model"; the same form as in Duclusaud, Passault, Padois and Ly 2024, "Extended
    friction models for the physics simulation of servo actuators".
    """

    name = "load_friction"
    native = False
    array = "load_share"
    words = EffectWords(
        "friction that grows with load",
        "{joint} has friction of {share} times its servo's torque {lacking}",
        "Gears and bearings rub harder the more torque passes through them.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The share s, below 1: with a larger one no motor could turn its gear."""
        return (Parameter("share", "1", 0.0, 0.8, 0.0, 0.1),)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) size of the torque by the nominal model, with the velocity's sign."""
        return np.abs(motion.torque_nm) * motion.direction


class Armature(JointNumber):
    """Torque -J a against a joint's acceleration a; J = (gear ratio)^2 rotor inertia.

    Source: gears in Featherstone 2008, "Rigid body dynamics algorithms", section 9.6.
    In MuJoCo `dof_armature`.
    """

    name = "armature"
    native = True
    array = "dof_armature"
    words = EffectWords(
        "rotor inertia",
        "{joint} has {inertia} of rotor inertia {lacking}",
        "The motor's rotor, geared up, resists acceleration as a flywheel does.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The inertia J [kg m^2], in addition to that of the nominal model."""
        scale = inertia_kg_m2(plant, place)
        return (Parameter("inertia", "kg m^2", 0.0, 10 * scale, 0.0, 0.5 * scale),)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) joint acceleration: the torque of an inertia of 1 kg m^2."""
        return motion.acceleration_rad_s2


class Backlash(ServoNumber):
    """A gap in the gear, within which no torque passes from motor to joint.

    The servo controls the motor's angle; the recorded encoder sits at the joint. Within
    the gap, whose size is the total play, the motor moves freely, slowed only by its
    damping; at the gap's edges it pushes the joint. See `diagnosis.replay.gaps`.

    Source: Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model.
    """

    name = "backlash"
    native = False
    array = "gap_rad"
    words = EffectWords(
        "play (backlash)",
        "{joint} has play of {gap} {lacking}",
        "Gears with a gap between their teeth: after each reversal the motor turns "
        "before the joint follows.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The gap [rad]: cheap gears have some hundredths of a radian."""
        return (Parameter("gap", "rad", 0.0, 0.15, 0.0, 0.02),)

    def first_tries(
        self,
        plant: "Plant",
        place: str,
        usage: "Usage",
        intervals: Sequence[Interval],
    ) -> list[Values]:
        """A small and a large gap [rad]: the effect is not linear in its size."""
        return [(0.01,), (0.03,)]

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) servo torque lost for a gap of 1 rad: kp / 2 sign(command - q)."""
        error = motion.command_rad - motion.position_rad
        return np.asarray(motion.kp_nm_rad * np.tanh(error / PLAY_RAD) / 2)


class EncoderOffset(JointNumber):
    """An encoder with a wrong zero: the servo acts on measured = true + offset.

    Source: joint offset of kinematic calibration, Hollerbach, Khalil and Gautier
    2016, "Model identification", Springer Handbook of Robotics.
    """

    name = "encoder_offset"
    native = False
    array = "offset_rad"
    joint_by_joint = False
    by_inverse_dynamics = True
    words = EffectWords(
        "encoder offset",
        "the encoder of {joint} is off by {offset}",
        "Measured angle less true angle, as after mounting a servo horn one tooth "
        "aside; the servo acts on the wrong angle, too.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The offset [rad] of the measured angle."""
        return (Parameter("offset", "rad", -0.3, 0.3, 0.0, 0.03),)
