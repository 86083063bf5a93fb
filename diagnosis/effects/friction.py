"""Effects of friction in joints: viscous, dry, with a peak at rest, and by load."""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.base_kinds import JointEffect, NumberEffect
from diagnosis.effects.parts import EffectWords, JointMotion, Parameter, Values
from diagnosis.effects.places import driven_joints
from diagnosis.effects.scales import brisk_rad_s, torque_nm, weak_friction_nm
from diagnosis.effects.variants import Joints, Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from diagnosis.verdict import PlacedEffect
from groundwalk.arrays import FloatArray

GROWN_SPEEDS_RAD_S = (0.02, 0.07, 0.25)
"""Stribeck speeds v_s that are tried once plain dry friction was found to help: below
v_s friction is larger."""

COLUMN_SPEED_RAD_S = 0.1
"""Stribeck speed v_s assumed in sparse regression, where friction is not linear in v_s
so that it cannot be fitted."""


class ViscousFriction(NumberEffect, JointEffect):
    """Torque -b v against a joint's speed v, as of an oil film.

    Source: the linear part of the static friction map in Armstrong-Helouvry, Dupont
    and Canudas de Wit 1994, "A survey of models, analysis tools and compensation
    methods for the control of machines with friction". In MuJoCo `dof_damping`.
    """

    name = "viscous_friction"
    shown_by = "speeds"
    native = True
    quantity = "dof_damping"
    words = EffectWords(
        "viscous friction",
        "{joint} has viscous friction of {coefficient} {lacking}",
        "A torque against the motion that grows with speed, as in thick grease.",
        "Warm the joint up and record again; if it stays, clean the gear and renew its "
        "grease.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The coefficient b [N m s/rad]; typical: 10 % of full torque in brisk use."""
        scale = torque_nm(plant, place) / brisk_rad_s(plant, place)
        return (Parameter("coefficient", "N m s/rad", 0.0, scale, 0.0, 0.1 * scale),)

    def spread(self, plant: Plant, place: str) -> float:
        """The grease in a gear takes some torque in brisk use."""
        return weak_friction_nm(plant, place) / brisk_rad_s(plant, place)

    def twins(self, plant: Plant, place: str) -> tuple[PlacedEffect, ...]:
        """Effects that look alike: larger servo damping, if there is back-EMF."""
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
        """Effect name, value, error; a coefficient below 0 is weaker servo damping."""
        if size >= 0 or damping_nm_s_rad <= 0:
            return self.name, size, error
        share = 1 / damping_nm_s_rad
        return "servo_damping", 1 + size * share, error * share


class CoulombFriction(NumberEffect, JointEffect):
    """Torque -tau sign(v), and up to tau against whatever drives a joint at rest.

    Source: dry friction after Coulomb 1785 as in Olsson, Astrom, Canudas de Wit,
    Gafvert and Lischinsky 1998, "Friction models and friction compensation",
    section 2. In MuJoCo `dof_frictionloss`.
    """

    name = "coulomb_friction"
    shown_by = "reversals"
    native = True
    jumps = True
    quantity = "coulomb_nm"
    words = EffectWords(
        "dry friction",
        "{joint} has dry friction of {torque} {lacking}",
        "A torque against the motion that is the same at all speeds; at rest it holds "
        "the joint until something stronger pulls.",
        "Look for what rubs: a bearing or a screw that is too tight, a bent shaft, a "
        "cable; a new gear rubs less after some hours.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The torque tau [N m], at most half of a large torque for the joint."""
        scale = torque_nm(plant, place)
        return (Parameter("torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),)

    def spread(self, plant: Plant, place: str) -> float:
        """Every gear rubs a little."""
        return weak_friction_nm(plant, place)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) smooth sign of the velocity: the torque of dry friction of 1 N m."""
        return motion.direction


class StribeckFriction(JointEffect):
    """Dry friction with a peak: torque -(tau_c + tau_s exp(-(v / v_s)^2)) sign(v).

    Source: Armstrong-Helouvry, Dupont and Canudas de Wit 1994, "A survey of models,
    analysis tools and compensation methods for the control of machines with
    friction"; the square in the exponent is Tustin's form as changed by Bo and
    Pavelescu 1982.
    """

    name = "stribeck_friction"
    shown_by = "speeds"
    native = False
    column_parameter = 1
    main_parameters = ("coulomb_torque", "extra_torque")
    words = EffectWords(
        "dry friction that sticks (Stribeck)",
        "{joint} has dry friction of {coulomb_torque}, and {extra_torque} more below "
        "{speed}, {lacking}",
        "Dry friction that is larger near standstill than in motion, so that slow "
        "movements stick and slip.",
        "A gear that sticks at rest wants cleaning and grease; a small dither of the "
        "command gets it moving.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Coulomb torque tau_c and extra torque tau_s [N m], and speed v_s [rad/s]."""
        scale = torque_nm(plant, place)
        return (
            Parameter("coulomb_torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),
            Parameter("extra_torque", "N m", 0.0, 0.5 * scale, 0.0, 0.04 * scale),
            Parameter("speed", "rad/s", 0.005, 2.0, 0.1, 0.1, logarithmic=True),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Add the friction to one variant."""
        coulomb_nm, extra_nm, speed_rad_s = values
        joints, at = copies.joints, (row, copies.column(place))
        joints.coulomb_nm[at] += coulomb_nm
        add_peak(joints, at, extra_nm, speed_rad_s)

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Stribeck friction to try after dry friction: half as much more at rest."""
        if other.name != "coulomb_friction":
            return ()
        (torque_nm,) = other.values
        return tuple(
            PlacedEffect(self.name, other.place, (torque_nm, 0.5 * torque_nm, speed))
            for speed in GROWN_SPEEDS_RAD_S
        )

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Values with two different speeds v_s: the effect is not linear in v_s."""
        coulomb, extra, _ = (one.typical for one in self.parameters(plant, place))
        return [(coulomb, extra, speed) for speed in (0.03, 0.2)]

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Dry friction alone, between the torques at high speed and at rest."""
        coulomb_nm, extra_nm, _ = placed.values
        mean_nm = coulomb_nm + extra_nm / 2
        return (PlacedEffect("coulomb_friction", placed.place, (mean_nm,)),)

    def native_part(self, placed: PlacedEffect) -> PlacedEffect | None:
        """Dry friction that is the same at all speeds; the peak is left out."""
        return PlacedEffect("coulomb_friction", placed.place, placed.values[:1])

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) friction near standstill for tau_s = 1 N m, along the velocity."""
        slow = np.exp(-((motion.velocity_rad_s / COLUMN_SPEED_RAD_S) ** 2))
        return np.asarray(slow * motion.direction)


class LoadFriction(NumberEffect, JointEffect):
    """Torque -s |tau| sign(v), with tau the servo's torque, its back-EMF included.

    The share s is below 1: with a larger one no motor could turn its gear.

    Source: Dohring, Lee and Newman 1993, "A load-dependent transmission friction
    model"; the same form as in Duclusaud, Passault, Padois and Ly 2024, "Extended
    friction models for the physics simulation of servo actuators".
    """

    name = "load_friction"
    shown_by = "poses"
    native = False
    scales_servo = True
    quantity = "load_share"
    usual = (Parameter("share", "1", 0.0, 0.8, 0.0, 0.1),)
    words = EffectWords(
        "friction that grows with load",
        "{joint} has friction of {share} times its servo's torque {lacking}",
        "Gears and bearings rub harder the more torque passes through them.",
        "This friction is the gear's: clean, grease or replace it, or let it carry "
        "less.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints that a servo or a torque drives."""
        return driven_joints(plant, traces)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) size of the torque by the nominal model, with the velocity's sign."""
        return np.abs(motion.torque_nm) * motion.direction


def add_peak(
    joints: Joints,
    at: tuple[int, int],
    extra_nm: float,
    speed_rad_s: float,
    exponent: float = 2.0,
) -> None:
    """Add a Stribeck peak to one joint of one variant, `at` (row, column) of arrays.

    Speeds and exponents of several peaks are averaged by their torques at rest [N m].
    """
    total_nm = joints.stribeck_nm[at] + extra_nm
    share = extra_nm / total_nm if total_nm > 0 else 1.0
    joints.stribeck_speed_rad_s[at] *= 1 - share
    joints.stribeck_speed_rad_s[at] += share * speed_rad_s
    joints.stribeck_exponent[at] *= 1 - share
    joints.stribeck_exponent[at] += share * exponent
    joints.stribeck_nm[at] = total_nm
