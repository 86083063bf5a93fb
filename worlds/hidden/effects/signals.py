"""Hidden physics of signals: delays of commands and encoders, and gyroscope bias."""

from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Setting
from worlds.hidden.surroundings import Surroundings


class CommandLatency(HiddenKind):
    """Commands reach all servos late, by a constant delay."""

    name = "command_latency"
    rank = 7
    place = "commands"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.06, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add this delay to that of the commands."""
        surroundings.command_delay_s += values["delay"]


class SensorDelay(HiddenKind):
    """The readings of all encoders are late, by a constant delay."""

    name = "sensor_delay"
    rank = 8
    place = "encoders"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.04, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add this delay to that of the encoders' readings."""
        surroundings.encoder_delay_s += values["delay"]

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the base is free; on a fixed one, late commands look the same."""
        return plant.floating


class GyroBias(HiddenKind):
    """A constant error of the gyroscope, added to the true turning rate."""

    name = "gyro_bias"
    rank = 10
    place = "gyroscope"
    quantities = tuple(Quantity(axis, "rad/s", -5.0, 5.0) for axis in "xyz")

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add this bias to that of each axis of the gyroscope."""
        surroundings.gyroscope_bias_rad_s += [values[axis] for axis in "xyz"]

    def size(self, s: Setting) -> dict[str, float]:
        """Bias of 0.003 (hard to detect) to 0.05 rad/s (easy), randomly directed."""
        bias = s.part(0.05, 0.003) * s.direction
        return dict(zip("xyz", bias.tolist(), strict=True))

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has a gyroscope, as all robots with a description have."""
        return plant.description is not None
