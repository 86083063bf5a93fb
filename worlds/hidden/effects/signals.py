"""Hidden physics of signals: delays, and a gyroscope's bias."""

from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Setting
from worlds.hidden.surroundings import Surroundings


class CommandLatency(HiddenKind):
    """Commands reach the servos late."""

    name = "command_latency"
    rank = 7
    place = "commands"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.06, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add to the delay of the commands."""
        surroundings.command_delay_s += values["delay"]


class SensorDelay(HiddenKind):
    """The encoders' readings are late."""

    name = "sensor_delay"
    rank = 8
    place = "encoders"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.04, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add to the delay of the encoders' readings."""
        surroundings.encoder_delay_s += values["delay"]

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the base is free: else late readings act as late commands do."""
        return plant.floating


class GyroBias(HiddenKind):
    """The gyroscope reads a constant turning rate too much."""

    name = "gyro_bias"
    rank = 10
    place = "gyroscope"
    quantities = tuple(Quantity(axis, "rad/s", -5.0, 5.0) for axis in "xyz")

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add to the bias of each axis of the gyroscope."""
        surroundings.gyroscope_bias_rad_s += [values[axis] for axis in "xyz"]

    def size(self, s: Setting) -> dict[str, float]:
        """Bias from 0.003 (hard to see) to 0.05 rad/s (easy), in any direction."""
        bias = s.part(0.05, 0.003) * s.direction
        return dict(zip("xyz", bias.tolist(), strict=True))

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has a gyroscope: those with a description do."""
        return plant.description is not None
