"""Effects of what a servo's firmware does with its error, beside stiffness and damping.

How replays step them, and in which order, is in `replay.controllers`. Torques for which
servos ask by their declared law tell nothing of them (see `CommandedServo`).
"""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.base_kinds import CommandedServo, NumberEffect
from diagnosis.effects.parts import EffectWords, Parameter, Values
from diagnosis.effects.places import joints_where
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.usage import Usage
from groundwalk.arrays import FloatArray

ON_S = 60.0
"""Time [s] for which a robot has been switched on, as a rule, when a recording begins.
An integral of a longer time has gathered only a part of what it will hold."""

SETTLED_S = ON_S / 3
"""Integral time [s] at which an integral has gathered 95 % of what it will hold. Where
it begins with a longer time, nobody knows."""

BAND_SHARES = (0.1, 0.4)
"""Dead bands that are tried first, as shares of the error at which the servo gives the
largest torque of the recordings. A band is not linear in its size; from 0.04 to 1 of
that error none is further from one of them than a factor of 2.5 (`STRETCHES`)."""


class IntegralTerm(CommandedServo):
    """A servo that also integrates its error e: kp (e + int e dt / time) - kd v.

    The integral's part is at most the servo's largest torque (anti-windup). A robot
    that is recorded has been switched on for a minute or more, so that the integral
    begins such that the servo nearly holds what gravity and motion need at the start,
    see `replay.controllers`. Under feet the ground bears a part of that, and how large
    a part is not known: only robots on a fixed base are searched for it.

    The value is the integral time [s], as data sheets of drives state it: usually 0.05
    to some seconds. Infinity stands for no integral; what acts is its inverse.

    Source: Astrom and Hagglund 1995, "PID controllers: theory, design, and tuning",
    chapter 3.
    """

    name = "integral_term"
    shown_by = "poses"
    native = False
    words = EffectWords(
        "servo that integrates its error",
        "the servo of {joint} integrates its error, with an integral time of {time}, "
        "unlike {usual}",
        "While an error lasts the servo pulls more and more, so that it does not sag "
        "under a load, and overshoots after a fast motion.",
        "Read the integral gain from the servo, and set it to 0 or state it in the "
        "sim.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The integral time [s], the same for all robots and places."""
        return (Parameter("time", "s", 0.05, 1000.0, np.inf, 1.0, logarithmic=True),)

    def faintest(self, plant: Plant, place: str) -> float | None:
        """The longest integral time [s] of which it is known where it begins."""
        return SETTLED_S

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints whose servo follows commands, on a fixed base only."""
        return super().places(plant, traces) if plant.base == "fixed" else ()

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Add the integral's gain to any other in one variant."""
        copies.joints.integral_1_s[row, copies.column(place)] += 1 / values[0]


class DeadBand(NumberEffect, CommandedServo):
    """A servo whose stiffness does nothing while its error e is small.

    Its torque is kp e - kd v where |e| is at least the width, else -kd v: it jumps at
    the band's edge, where play in a gear (`backlash`) lacks half of the gap for all
    larger errors as well. An integral term takes an error within the band as 0, too.

    Bus servos have such a band against chatter, of 1 to 32 steps of 1.5 mrad.

    Source: Feetech, "STS series memory table", addresses 26 and 27.
    """

    name = "dead_band"
    shown_by = "reversals"
    native = False
    finer = 4  # within a step the servo pulls or not
    quantity = "dead_band_rad"
    combined = np.maximum
    usual = (Parameter("width", "rad", 0.0, 0.15, 0.0, 0.01),)
    words = EffectWords(
        "dead band of the servo",
        "the servo of {joint} does not pull while its error is below {width}, unlike "
        "{usual}",
        "The servo's firmware takes small errors as none, so that it does not chatter "
        "where it rests.",
        "Look at the servo's setting for its dead band or dead zone.",
    )

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """A narrow and a wide band [rad], see `BAND_SHARES`."""
        column = plant.joints.index(place)
        (width,) = self.usual
        kp = float(plant.servo.kp_nm_rad[column])
        error = float(usage.torque_nm[column]) / kp if kp > 0 else width.typical
        return [(min(max(k * error, 1e-4), width.high),) for k in BAND_SHARES]


class ErrorDerivative(NumberEffect, CommandedServo):
    """A servo whose damping acts on the rate of its error, not on speed alone.

    Its torque is kp e + kd (share dc/dt - v), with c the set-point that its firmware
    has: after delays, and slowed down by a speed limit. A share of 0 damps the joint's
    speed v, one of 1 is the derivative of the error.

    Commands are steps, whose rate is infinite for a moment. As in every controller with
    a derivative it is smoothed: dc/dt is that of c behind a lag of kd / (10 kp), so
    that a step of c gives an impulse of kd times the step, which the torque limit may
    clip. Lags are usually kd / kp over 2 to 20; in smooth motion none of them shows.

    Source: filtered derivative and set-point weight of the derivative, Astrom and
    Hagglund 2006, "Advanced PID control", chapter 3.
    """

    name = "error_derivative"
    shown_by = "accelerations"
    native = False
    quantity = "rate_share"
    usual = (Parameter("share", "1", 0.0, 1.0, 0.0, 0.3, full=True),)
    words = EffectWords(
        "damping of the error's rate",
        "the servo of {joint} takes {share} of its target's speed from the speed that "
        "it damps, unlike {usual}",
        "The servo's firmware differentiates its error instead of the joint's speed, "
        "so that it damps less while its target moves.",
        "Look up whether the servo's D gain acts on the error or on the speed.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of joints whose servo follows commands and has damping of its own."""
        servos = [trace.servo for trace in traces] or [plant.servo]
        damped = joints_where(plant, [servo.kd_nm_s_rad > 0 for servo in servos])
        return tuple(one for one in super().places(plant, traces) if one in damped)
