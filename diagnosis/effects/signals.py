"""Effects on signals: late commands, late encoders, and a bias of the gyroscope."""

from collections.abc import Sequence

from diagnosis.effects.bases import NumberEffect
from diagnosis.effects.parts import EffectWords, JointMotion, Parameter, PlacedEffect
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray


class CommandLatency(NumberEffect):
    """The servo acts on command(t - delay): a dead time of bus and firmware.

    It is usually 2 to 60 ms; 0.5 s has been seen on a slow bus.

    Source: transfer function exp(-s delay), Astrom and Murray 2008, "Feedback
    systems", section 8.2. In MuJoCo the actuator's `delay`.
    """

    name = "command_latency"
    place_kind = "commands"
    native = True
    quantity = "command_delay_s"
    usual = (Parameter("delay", "s", 0.0, 0.6, 0.0, 0.015),)
    words = EffectWords(
        "late commands",
        "commands take effect {delay} later than {usual}",
        "The time from sending a command until the servos act on it.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("commands",) if a recording has position or torque commands, else ()."""
        has_commands = any(
            trace.command_rad is not None or trace.command_torque_nm is not None
            for trace in traces
        )
        return ("commands",) if has_commands else ()

    def twins(self, plant: Plant, place: str) -> tuple[PlacedEffect, ...]:
        """Late encoders if the base is fixed: joint positions then look the same."""
        late = PlacedEffect("sensor_delay", "encoders")
        return (late,) if plant.base == "fixed" else ()

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) servo torque lost per second of delay: kp times command rate."""
        return motion.kp_nm_rad * motion.command_rate_rad_s


class SensorDelay(NumberEffect):
    """Late encoders: measured(t) = true(t - delay), positions and velocities.

    The delay is usually 2 to 40 ms.

    Source: transfer function exp(-s delay), Astrom and Murray 2008, "Feedback
    systems", section 8.2.
    """

    name = "sensor_delay"
    place_kind = "encoders"
    native = False
    rarity_nats = 1.0
    quantity = "sensor_delay_s"
    usual = (Parameter("delay", "s", 0.0, 0.2, 0.0, 0.01),)
    words = EffectWords(
        "late sensors",
        "joint positions and velocities are {delay} older than their time stamps say",
        "What the sensors report has already passed when it gets its time stamp.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("encoders",), or () if only joint positions are measured on a fixed base.

        Late encoders then cannot be distinguished from late commands.
        """
        other = any(trace.torque_nm is not None for trace in traces)
        return ("encoders",) if plant.base == "floating" or other else ()


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
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("gyroscope",) if a recording has gyroscope measurements, else ()."""
        has_one = any(trace.gyroscope_rad_s is not None for trace in traces)
        return ("gyroscope",) if has_one else ()
