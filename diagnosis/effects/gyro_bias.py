"""The effect gyro bias: the gyroscope has a constant error."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import EffectWords, Parameter, PlaceKind
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class GyroBias(Effect):
    """A constant error of the gyroscope: measured = true + bias, in the sensor frame.

    Source: the usual inertial sensor model without drift, for example Titterton and
    Weston 2004, "Strapdown inertial navigation technology".
    """

    name = "gyro_bias"
    place_kind: ClassVar[PlaceKind] = "gyroscope"
    native = False
    components = 3
    words = EffectWords(
        "gyroscope bias",
        "the gyroscope is off by {x} about x, {y} about y and {z} about z",
        "The gyroscope reports a turn rate even when nothing turns.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """("gyroscope",) if a recording has gyroscope measurements, else ()."""
        has_one = any(trace.gyroscope_rad_s is not None for trace in traces)
        return ("gyroscope",) if has_one else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The bias [rad/s] of each axis of the sensor."""
        return tuple(Parameter(axis, "rad/s", -0.5, 0.5, 0.0, 0.02) for axis in "xyz")

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the bias to that of the gyroscope in one variant of the model."""
        variants.signals.gyro_bias_rad_s[row] += values
