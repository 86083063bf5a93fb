"""Hidden physics of signals: delays, and a gyroscope's bias."""

from typing import TYPE_CHECKING

from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.setting import Setting
from worlds.hidden.surroundings import Surroundings

if TYPE_CHECKING:
    from worlds.hidden.plant import HiddenPlant


class CommandLatency(HiddenKind):
    """Commands reach the servos late."""

    name = "command_latency"
    rank = 7
    place = "commands"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.06, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add to the delay."""
        surroundings.command_delay_s += values["delay"]


class SensorDelay(HiddenKind):
    """The encoders' readings are late."""

    name = "sensor_delay"
    rank = 8
    place = "encoders"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.04, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add to the delay."""
        surroundings.encoder_delay_s += values["delay"]

    def possible(self, plant: "HiddenPlant") -> bool:
        """On a fixed base late readings cannot be distinguished from late commands."""
        return plant.floating


class GyroBias(HiddenKind):
    """The gyroscope reads a constant turning rate too much."""

    name = "gyro_bias"
    rank = 10
    place = "gyroscope"
    quantities = tuple(Quantity(axis, "rad/s", -5.0, 5.0) for axis in "xyz")

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add to the bias, axis by axis."""
        surroundings.gyroscope_bias_rad_s += [values[axis] for axis in "xyz"]

    def size(self, s: Setting) -> dict[str, float]:
        """From 0.003 to 0.05 rad/s, in any direction."""
        bias = s.part(0.05, 0.003) * s.direction
        return dict(zip("xyz", bias.tolist(), strict=True))

    def possible(self, plant: "HiddenPlant") -> bool:
        """Only robots with a description have a gyroscope."""
        return plant.description is not None
