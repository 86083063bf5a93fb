"""Effects of sensors: late encoders, a gyroscope's bias, a wrong scale of torques."""

from collections.abc import Sequence

import numpy as np

from diagnosis.effects.base_kinds import JointEffect, NumberEffect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace, asked


class TorqueScale(NumberEffect, JointEffect):
    """A wrong scale of measured torques: measured = factor * true.

    Torques are usually measured as motor currents: a wrong torque constant or gear
    ratio is a wrong scale, and so is a sensor that was calibrated badly.

    Source: identification of drive gains, Gautier and Briot 2014, "Global
    identification of joint drive gains and dynamic parameters of robots".
    """

    name = "torque_scale"
    native = False
    no_law = "it is in what a recording says of torques, not in how the robot moves"
    replayed = False
    on_every_servo = False
    rarity_nats = 1.0
    quantity = "torque_factor"
    combined = np.multiply
    usual = (Parameter("factor", "1", 0.1, 10.0, 1.0, 1.2, logarithmic=True),)
    words = EffectWords(
        "scale of measured torque",
        "the measured torque of {joint} is {factor} times the true one",
        "A motor's torque constant, a gear ratio or a torque sensor is not what the "
        "recording takes it for.",
        "Check the torque constant by which currents became torques.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of all joints if measured torques are compared, else ()."""
        compared = bool(traces) and all(trace.motion is not None for trace in traces)
        return plant.joints if compared and not asked(traces) else ()

    def tolerance(self, plant: Plant, place: str) -> float:
        """2 %: the accuracy to which the constants of a motor are known."""
        return 0.02

    def spread(self, plant: Plant, place: str) -> float:
        """3 %: makers state the constants of motors to 10 % at most."""
        return 0.03


class SensorDelay(NumberEffect):
    """Late encoders: measured(t) = true(t - delay), positions and velocities.

    The delay is usually 2 to 40 ms.

    Source: transfer function exp(-s delay), Astrom and Murray 2008, "Feedback
    systems", section 8.2. In MuJoCo a sensor's `delay`.
    """

    name = "sensor_delay"
    shown_by = "accelerations"
    place_kind = "encoders"
    native = True
    rarity_nats = 1.0
    quantity = "sensor_delay_s"
    usual = (Parameter("delay", "s", 0.0, 0.2, 0.0, 0.01),)
    words = EffectWords(
        "late sensors",
        "joint positions and velocities are {delay} older than their time stamps say",
        "What the sensors report has already passed when it gets its time stamp.",
        "Read the encoders later in the cycle, or stamp their values with the time at "
        "which they were read.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("encoders",), or () if only joint positions are measured on a fixed base.

        Late encoders then cannot be distinguished from late commands.
        """
        measured = any(trace.torque_nm is not None for trace in traces)
        other = measured and not asked(traces)
        return ("encoders",) if plant.base == "floating" or other else ()


class LateReading(NumberEffect, JointEffect):
    """One joint is read later than others: measured(t) = true(t - delay) at this joint.

    The servo acts on its own, fresh reading. A bus that asks one servo after the other
    takes 0.2 to 5 ms for each.

    On a fixed base time is only known from the commands: if all joints are read late,
    commands that take effect late look the same, so that the least of all delays is
    `command_latency`, and what this effect says is later than that. A command that one
    servo alone gets late looks the same, too, but for what its joint does to others,
    which hardly shows where servos are stiff.

    In MuJoCo the `delay` of a sensor.

    Source: round-robin polling, as in the protocols of Dynamixel and Feetech servos;
    transfer function exp(-s delay), Astrom and Murray 2008, "Feedback systems".
    """

    name = "late_reading"
    native = True
    shown_by = "accelerations"
    of_motor = False
    rarity_nats = 1.0
    quantity = "late_s"
    usual = (Parameter("delay", "s", 0.0, 0.2, 0.0, 0.005),)
    words = EffectWords(
        "late reading of one joint",
        "the position of {joint} is read {delay} later than its time stamp says",
        "Servos on one bus are asked one after the other, and a row of the recording "
        "has one time for all of them.",
        "Read all servos at once (sync read), or stamp each value with its own time.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of all joints, if there are several; () where servos' torques count.

        A single joint that is read late looks like late commands. And where servos'
        torques are compared, they follow from the readings.
        """
        alone = len(plant.joints) < 2
        return () if alone or asked(traces) else super().places(plant, traces)


class GyroBias(NumberEffect):
    """A constant error of the gyroscope: measured = true + bias, in the sensor frame.

    Source: the usual inertial sensor model without drift, for example Titterton and
    Weston 2004, "Strapdown inertial navigation technology".
    """

    name = "gyro_bias"
    place_kind = "gyroscope"
    native = False
    components = 3
    quantity = "gyro_bias_rad_s"
    usual = tuple(Parameter(axis, "rad/s", -0.5, 0.5, 0.0, 0.02) for axis in "xyz")
    words = EffectWords(
        "gyroscope bias",
        "the gyroscope is off by {x} about x, {y} about y and {z} about z",
        "The gyroscope reports a turn rate even when nothing turns.",
        "Measure the gyroscope while the robot stands still, and subtract what it "
        "shows.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("gyroscope",) if a recording has gyroscope measurements, else ()."""
        has_one = any(trace.gyroscope_rad_s is not None for trace in traces)
        return ("gyroscope",) if has_one else ()
