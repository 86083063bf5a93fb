"""The effect sensor delay: encoders report past positions and velocities."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import EffectWords, Parameter, PlaceKind
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class SensorDelay(Effect):
    """Late encoders: measured(t) = true(t - delay), positions and velocities.

    Source: transfer function exp(-s delay), Astrom and Murray 2008, "Feedback
    systems", section 8.2.
    """

    name = "sensor_delay"
    place_kind: ClassVar[PlaceKind] = "encoders"
    native = False
    rarity_nats = 1.0
    words = EffectWords(
        "late sensors",
        "joint positions and velocities are {delay} older than their time stamps say",
        "What the sensors report has already passed when it gets its time stamp.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """("encoders",), or () if only joint positions are measured on a fixed base.

        Late encoders then cannot be distinguished from late commands.
        """
        other = any(trace.torque_nm is not None for trace in traces)
        return ("encoders",) if plant.base == "floating" or other else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The delay [s]: usually 2 to 40 ms."""
        return (Parameter("delay", "s", 0.0, 0.2, 0.0, 0.01),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the delay to that of all encoders in one variant of the model."""
        variants.signals.sensor_delay_s[row] += values[0]
