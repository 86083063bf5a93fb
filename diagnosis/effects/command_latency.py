"""The effect command latency: commands take effect late."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import (
    EffectWords,
    JointMotion,
    Parameter,
    PlacedEffect,
    PlaceKind,
)
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class CommandLatency(Effect):
    """The servo acts on command(t - delay): a dead time of bus and firmware.

    Source: transfer function exp(-s delay), Astrom and Murray 2008, "Feedback
    systems", section 8.2. In MuJoCo the actuator's `delay`.
    """

    name = "command_latency"
    place_kind: ClassVar[PlaceKind] = "commands"
    native = True
    words = EffectWords(
        "late commands",
        "commands take effect {delay} later than {usual}",
        "The time from sending a command until the servos act on it.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """("commands",) if a recording has position or torque commands, else ()."""
        has_commands = any(
            trace.command_rad is not None or trace.command_torque_nm is not None
            for trace in traces
        )
        return ("commands",) if has_commands else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The delay [s]: usually 2 to 60 ms; 0.5 s has been seen on a slow bus."""
        return (Parameter("delay", "s", 0.0, 0.6, 0.0, 0.015),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the delay to that of all commands in one variant of the model."""
        variants.signals.command_delay_s[row] += values[0]

    def twins(self, plant: "Plant", place: str) -> tuple[PlacedEffect, ...]:
        """Late encoders if the base is fixed: joint positions then look the same."""
        late = PlacedEffect("sensor_delay", "encoders")
        return (late,) if plant.base == "fixed" else ()

    def torque_column(self, motion: JointMotion) -> FloatArray:
        """(rows,) servo torque lost per second of delay: kp times command rate."""
        return motion.kp_nm_rad * motion.command_rate_rad_s
