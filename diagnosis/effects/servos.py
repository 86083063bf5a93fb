"""Effects of servos and signals: gains, limits, delays, and a bias of the gyroscope."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.base_kinds import (
    JointEffect,
    NumberEffect,
    ServoEffect,
)
from diagnosis.effects.effect import LIMITS
from diagnosis.effects.parts import (
    EARLIEST_S,
    LONGEST_S,
    EffectWords,
    JointMotion,
    Parameter,
    Values,
)
from diagnosis.effects.places import driven_joints, joints_where
from diagnosis.effects.scales import torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from diagnosis.verdict import PlacedEffect, When
from groundwalk.arrays import FloatArray

WEAKER = (0.65, 0.8, 0.9, 0.96)
"""Shares of a servo's nominal torque limit that are tried as its true limit: if only
sudden changes of the command reach the limit, other first guesses are poor."""


class ServoGain(NumberEffect, ServoEffect):
    """A factor on the servo's stiffness: torque = factor kp (command - q) - kd v.

    Source: proportional part of a position loop, Spong, Hutchinson and Vidyasagar
    2006, "Robot modeling and control", chapter 6. In MuJoCo `actuator_gainprm` and
    `actuator_biasprm`.
    """

    name = "servo_gain"
    shown_by = "poses"
    native = True
    scales_servo = True
    stiffens = True
    quantity = "kp_factor"
    combined = np.multiply
    usual = (Parameter("factor", "1", 0.1, 5.0, 1.0, 0.8, logarithmic=True),)
    words = EffectWords(
        "servo stiffness",
        "the servo of {joint} has {factor} times its stiffness {usual}",
        "The torque that the servo gives for each radian of error is another one.",
        "Read the gain from the servo, and measure its supply voltage: the stiffness "
        "is proportional to both.",
    )

    def tolerance(self, plant: Plant, place: str) -> float:
        """1 %, as motors of one type differ."""
        return 0.01

    def spread(self, plant: Plant, place: str) -> float:
        """3 %: makers state the constants of motors to 10 % at most."""
        return 0.03

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) torque of the nominal stiffness; the share 1 - factor is missing."""
        return motion.pull_nm

    def from_column(
        self, size: float, error: float, damping_nm_s_rad: float
    ) -> tuple[str, float, float]:
        """Effect name, factor and its error, from the missing share of stiffness."""
        return self.name, 1 - size, error


class ServoDamping(NumberEffect, JointEffect):
    """A factor on servo damping and back-EMF at speed v: torque -factor (kd + emf) v.

    Source: derivative part of a position loop and the motor's induced voltage, Spong,
    Hutchinson and Vidyasagar 2006, "Robot modeling and control", chapter 6. In
    MuJoCo `actuator_biasprm` and `dof_damping`.
    """

    name = "servo_damping"
    shown_by = "accelerations"
    native = True
    scales_servo = True
    rarity_nats = 2.0
    quantity = "damping_factor"
    combined = np.multiply
    usual = (Parameter("factor", "1", 0.05, 20.0, 1.0, 1.5, logarithmic=True),)
    words = EffectWords(
        "servo damping",
        "the servo of {joint} has {factor} times its damping {usual}",
        "The torque with which servo and motor brake, for each rad/s, is another one.",
        "Read the derivative gain from the servo; the rest of its damping is the "
        "motor's back-EMF.",
    )

    def tolerance(self, plant: Plant, place: str) -> float:
        """3 %: damping depends on temperature, and data sheets hardly state it."""
        return 0.03

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints whose servo has damping or back-EMF in any recording."""
        servos = [trace.servo for trace in traces] or [plant.servo]
        damping = [one.kd_nm_s_rad + one.back_emf_nm_s_rad for one in servos]
        return joints_where(plant, [values > 0 for values in damping])


class ServoFade(NumberEffect, ServoEffect):
    """A servo that loses stiffness: kp (1 - rate t), t since the recording began.

    Typical is a loss of 3 to 30 % in 10 to 60 s.

    Source: falling supply voltage or warming of winding and magnet reduce a motor's
    torque, here to first order; Hughes and Drury 2019, "Electric motors and drives",
    chapter 3.
    """

    name = "servo_fade"
    native = False
    on_every_servo = False
    rarity_nats = 1.0
    quantity = "fade_1_s"
    usual = (Parameter("rate", "1/s", 0.0, 0.05, 0.0, 0.005),)
    words = EffectWords(
        "servo that weakens",
        "the servo of {joint} loses {rate} of its stiffness, unlike {usual}",
        "A motor that gets hot, or a battery that runs down, pulls less and less.",
        "Watch the motor's temperature and the supply voltage; let it cool, charge the "
        "battery.",
    )

    def acted(self, placed: PlacedEffect, first_s: float, last_s: float) -> When:
        """As a drift in all recordings, since the effect grows with time."""
        return When("drift", first_s, last_s)

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) servo torque lost for a rate of 1/s: torque of nominal kp times t."""
        return motion.since_s * motion.pull_nm


class ServoOff(JointEffect):
    """A motor without torque, or with less of it, from one moment on or for some time.

    Stiffness, damping and motor torque are (1 - share) times the nominal ones from
    `start` for `duration`, in the recording's time.

    Source: smart servos switch their torque off at overload, heat or low voltage until
    they are told otherwise (Robotis e-Manual, MX-28, "Shutdown").
    """

    name = "servo_off"
    native = False
    timed = True
    lasting = False
    joint_by_joint = False
    on_every_servo = False
    rarity_nats = 3.0
    main_parameters = ("share",)
    words = EffectWords(
        "motor that switches off",
        "the motor of {joint} lost {share} of its torque",
        "A servo switches itself off at overload, heat or low voltage; a motor dies.",
        "Read the servo's error register: overload, heat and low voltage switch it "
        "off.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The share that is lost; start and duration [s]."""
        return (
            Parameter("share", "1", 0.0, 1.0, 0.0, 1.0, full=True),
            Parameter("start", "s", EARLIEST_S, LONGEST_S, 0.0, 0.2),
            Parameter("duration", "s", 0.0, LONGEST_S, 0.0, 0.2),
        )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints that a servo or a recorded torque drives."""
        return driven_joints(plant, traces)

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Switch the motor off in one variant of the model."""
        share, start_s, duration_s = (float(value) for value in values)
        joints, at = copies.joints, (row, copies.column(place))
        joints.off_share[at] = share
        joints.off_start_s[at], joints.off_end_s[at] = start_s, start_s + duration_s


class TorqueLimit(NumberEffect, JointEffect):
    """A torque limit below the nominal one: torque = clip(demand, -limit, limit).

    Source: actuator saturation, Spong, Hutchinson and Vidyasagar 2006, "Robot modeling
    and control", chapter 6. In MuJoCo `actuator_forcerange`.
    """

    name = "torque_limit"
    shown_by = "accelerations"
    native = True
    threshold = True
    quantity = "max_torque_nm"
    combined = np.minimum
    words = EffectWords(
        "torque limit",
        "the motor of {joint} gives no more than {torque}, less than {usual}",
        "A motor that is weaker than the data sheet says, or a current limit.",
        "Look at the servo's limits of current and torque, and at the supply voltage "
        "under load.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The limit [N m], at most the nominal one: a larger one has no effect."""
        scale = torque_nm(plant, place)
        own = float(plant.servo.max_torque_nm[plant.joints.index(place)])
        high = scale if np.isfinite(own) else 5 * scale
        low, typical = 0.02 * scale, 0.6 * scale
        return (Parameter("torque", "N m", low, high, np.inf, typical, True),)

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Limits at 90, 70 and 45 % of the torque that the nominal servo would give."""
        torque = usage.torque_nm[plant.joints.index(place)]
        return [(share * torque,) for share in (0.9, 0.7, 0.45)]

    def sizes_to_scan(
        self, plant: Plant, placed: PlacedEffect, traces: Sequence[Trace]
    ) -> list[PlacedEffect]:
        """Limits around the guess, and limits at some shares of the nominal limit."""
        column = plant.joints.index(placed.place)
        most = float(max(trace.servo.max_torque_nm[column] for trace in traces))
        limits = [k * placed.values[0] for k in LIMITS]
        limits += [share * most for share in WEAKER if np.isfinite(most)]
        return [replace(placed, values=(limit,)) for limit in limits]


class CommandLatency(NumberEffect):
    """The servo acts on command(t - delay): a dead time of bus and firmware.

    It is usually 2 to 60 ms; 0.5 s has been seen on a slow bus.

    Source: transfer function exp(-s delay), Astrom and Murray 2008, "Feedback
    systems", section 8.2. In MuJoCo the actuator's `delay`.
    """

    name = "command_latency"
    shown_by = "accelerations"
    place_kind = "commands"
    native = True
    quantity = "command_delay_s"
    usual = (Parameter("delay", "s", 0.0, 0.6, 0.0, 0.015),)
    words = EffectWords(
        "late commands",
        "commands take effect {delay} later than {usual}",
        "The time from sending a command until the servos act on it.",
        "Look at the way from the program to the servos: rate of the bus, buffers, "
        "interpolation.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("commands",) if a recording has position or torque commands, else ()."""
        has_commands = any(
            trace.command_rad is not None or trace.command_torque_nm is not None
            for trace in traces
        )
        return ("commands",) if has_commands else ()

    def tolerance(self, plant: Plant, place: str) -> float:
        """0.2 ms: the jitter of a clock."""
        return 2e-4

    def twins(self, plant: Plant, place: str) -> tuple[PlacedEffect, ...]:
        """Effects that look alike: late encoders, if the base is fixed."""
        late = PlacedEffect("sensor_delay", "encoders")
        return (late,) if plant.base == "fixed" else ()

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) servo torque lost per second of delay: kp times command rate."""
        return motion.kp_nm_rad * motion.command_rate_rad_s


def late_commands(delay_s: float) -> PlacedEffect:
    """Commands that all take effect later than their rows say [s]."""
    return PlacedEffect(CommandLatency.name, "commands", (delay_s,))
