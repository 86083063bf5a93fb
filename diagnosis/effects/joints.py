"""Effects of a joint's mechanics: inertia, springs, stops and its encoder."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.base_kinds import JointEffect, NumberEffect, TorqueEffect
from diagnosis.effects.parts import EffectWords, JointMotion, Parameter, Values
from diagnosis.effects.scales import inertia_kg_m2, range_rad, torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace, asked
from diagnosis.traces.usage import Usage
from diagnosis.verdict import PlacedEffect
from groundwalk.arrays import FloatArray

_FAR_RAD = 1e6
"""Bound of the angle of a joint without a range: so large that it acts as no bound."""

_STIFF_S, _SOFT_S = 0.005, 0.02
"""Time constants of a hard end stop, and of one that yields as MuJoCo's usual ones."""


class Armature(NumberEffect, JointEffect):
    """Torque -J a against a joint's acceleration a; J = (gear ratio)^2 rotor inertia.

    Source: gears in Featherstone 2008, "Rigid body dynamics algorithms", section 9.6.
    In MuJoCo `dof_armature`.
    """

    name = "armature"
    shown_by = "accelerations"
    native = True
    quantity = "dof_armature"
    words = EffectWords(
        "rotor inertia",
        "{joint} has {inertia} of rotor inertia {lacking}",
        "The motor's rotor, geared up, resists acceleration as a flywheel does.",
        "Take the rotor's inertia from the data sheet, times the squared gear ratio.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The inertia J [kg m^2], in addition to that of the nominal model."""
        scale = inertia_kg_m2(plant, place)
        return (Parameter("inertia", "kg m^2", 0.0, 10 * scale, 0.0, 0.5 * scale),)

    def tolerance(self, plant: Plant, place: str) -> float:
        """1 % of all inertia at the joint, rotor included, in the reference pose."""
        return 0.01 * inertia_kg_m2(plant, place)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) joint acceleration: the torque of an inertia of 1 kg m^2."""
        return motion.acceleration_rad_s2


class EncoderOffset(NumberEffect, JointEffect):
    """An encoder with a wrong zero: the servo acts on measured = true + offset.

    Source: joint offset of kinematic calibration, Hollerbach, Khalil and Gautier
    2016, "Model identification", Springer Handbook of Robotics. In MuJoCo the joint's
    `ref`: then `qpos` is the measured angle.
    """

    name = "encoder_offset"
    shown_by = "poses"
    native = True
    joint_by_joint = False
    of_motor = False
    by_inverse_dynamics = True
    quantity = "offset_rad"
    usual = (Parameter("offset", "rad", -0.3, 0.3, 0.0, 0.03),)
    words = EffectWords(
        "encoder offset",
        "the encoder of {joint} is off by {offset}",
        "Measured angle less true angle, as after mounting a servo horn one tooth "
        "aside; the servo acts on the wrong angle, too.",
        "Home the joint again, or correct its zero.",
    )

    def tolerance(self, plant: Plant, place: str) -> float:
        """1 mrad: how well a joint's zero is usually calibrated."""
        return 1e-3


class JointSpring(JointEffect):
    """Torque -k (q - rest) at joint angle q.

    Source: Hooke 1678. In MuJoCo `jnt_stiffness` and `qpos_spring`.
    """

    name = "joint_spring"
    shown_by = "poses"
    native = True
    of_motor = False
    main_parameters = ("stiffness",)
    words = EffectWords(
        "spring at a joint",
        "{joint} has a spring of {stiffness} that pulls to {rest}, {lacking}",
        "A cable, a hose or a return spring pulls the joint to one angle.",
        "Look for cables and hoses that bend with the joint.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Stiffness k [N m/rad]; rest angle [rad], by default the reference pose's."""
        scale = torque_nm(plant, place)
        low, high = range_rad(plant, place)
        reference = plant.model.qpos0[plant.qpos[plant.joints.index(place)]]
        rest = float(np.clip(reference, low, high))
        return (
            Parameter("stiffness", "N m/rad", 0.0, 5 * scale, 0.0, 0.2 * scale),
            Parameter("rest", "rad", low, high, rest, rest),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Merge the spring with any other at the joint in one variant of the model.

        Stiffnesses are added; rest angles are averaged, weighted by stiffness.
        """
        stiffness, rest = values
        if stiffness == 0:
            return
        joint = copies.plant.model.joint(place).id
        qpos = copies.plant.qpos[copies.column(place)]
        stiffnesses = copies.field("jnt_stiffness")
        rests = copies.field("qpos_spring")
        total = stiffnesses[row, joint] + stiffness
        rests[row, qpos] += stiffness / total * (rest - rests[row, qpos])
        stiffnesses[row, joint] = total

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Springs with rest angles in the middle and at both ends of the motion."""
        column = plant.joints.index(place)
        low, high = usage.low_rad[column], usage.high_rad[column]
        stiffness = self.parameters(plant, place)[0].typical
        return [(stiffness, rest) for rest in ((low + high) / 2, low, high)]

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) joint angle; the rest angle adds a constant torque of its own."""
        return motion.position_rad


class TorqueOffset(TorqueEffect):
    """Constant torque at a joint, in the direction of growing angles if positive.

    Source: the offset in the friction of EMPS, Janot, Gautier and Brunot 2019, "Data
    set and reference models of EMPS". In MuJoCo `actuator_biasprm` of the joint's
    actuator, whose `forcerange` is shifted by as much.
    """

    name = "torque_offset"
    shown_by = "poses"
    native = True
    of_motor = False
    words = EffectWords(
        "constant torque",
        "a constant torque of {torque} acts on {joint}, {lacking}",
        "Friction that differs between the directions, a cable that pulls, or a weight "
        "that is not balanced as in the model.",
        "Look for a cable under tension, a balancing spring, or a torque sensor that "
        "does not show 0 at rest.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Torque [N m], at most that of the joint's servo."""
        scale = torque_nm(plant, place)
        return (Parameter("torque", "N m", -scale, scale, 0.0, 0.05 * scale),)

    def torque_nm(
        self,
        values: FloatArray,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        time_s: FloatArray,
    ) -> FloatArray:
        """(rows, j) the torques themselves; see `TorqueEffect`."""
        return np.broadcast_to(values[..., 0], np.shape(position_rad))


class EndStop(JointEffect):
    """A hard stop: joint angle q <= angle (side +1) or q >= angle (side -1).

    The stop pushes the joint back, critically damped, with a time constant of 5 ms, or
    of two physics steps if that is longer, as MuJoCo demands.

    Source: complementarity between distance and force, Brogliato 2016, "Nonsmooth
    mechanics". In MuJoCo `jnt_range`.
    """

    name = "end_stop"
    shown_by = "poses"
    native = True
    threshold = True
    on_every_servo = False
    main_parameters = ("angle",)
    words = EffectWords(
        "end stop",
        "{joint} hits a stop at {angle} {lacking}",
        "Something stops the joint before the end of its nominal range.",
        "Move the joint by hand to where it stops: something is in its way.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of all joints, if motions are replayed or torques were measured.

        A joint against a stop hardly moves, so that the law of its servo tells nothing.
        """
        return () if asked(traces) else super().places(plant, traces)

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Angle of the stop [rad], and side, whose sign says which way it blocks."""
        low, high = range_rad(plant, place)
        is_limited = plant.model.jnt_limited[plant.model.joint(place).id]
        neutral = high if is_limited else np.inf
        typical = low + 0.75 * (high - low)
        return (
            Parameter("angle", "rad", low, high, neutral, typical),
            Parameter("side", "1", -1.0, 1.0, 1.0, 1.0),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Narrow a joint's range in one variant; stops outside it change nothing.

        A third value is the time constant [s] with which it pushes back.
        """
        angle, side, *soft_s = (float(value) for value in values)
        joint = copies.plant.model.joint(place).id
        limited, ranges = copies.field("jnt_limited"), copies.field("jnt_range")
        low, high = ranges[row, joint] if limited[row, joint] else (-_FAR_RAD, _FAR_RAD)
        if not low < angle < high:
            return
        ranges[row, joint] = (low, angle) if side > 0 else (angle, high)
        limited[row, joint] = 1
        copies.field("jnt_solref")[row, joint] = *(soft_s or [_STIFF_S]), 1.0

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Stops at either end of the joint's recorded range, and 5 and 20 % inside."""
        column = plant.joints.index(place)
        low, high = usage.low_rad[column], usage.high_rad[column]
        span = high - low
        return [
            (end + side * -share * span, side)
            for end, side in ((high, 1.0), (low, -1.0))
            for share in (0.0, 0.05, 0.2)
        ]

    def sizes_to_scan(
        self, plant: Plant, placed: PlacedEffect, traces: Sequence[Trace]
    ) -> list[PlacedEffect]:
        """Only the guess `placed`: a scaled angle would not scale the effect."""
        return [placed]

    def softer(self, plant: Plant, placed: PlacedEffect) -> PlacedEffect:
        """With a stop that yields, with a time constant of 20 ms."""
        return replace(placed, values=(*placed.values, _SOFT_S))

    def neutral_values(self, plant: Plant, placed: PlacedEffect) -> Values:
        """Values without effect: the range's end on the stop's side, and side +1."""
        angle, side = self.parameters(plant, placed.place)
        if placed.values and placed.values[1] < 0:
            return angle.low, side.neutral
        return angle.neutral, side.neutral
