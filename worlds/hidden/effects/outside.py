"""Hidden physics outside of joints and bodies: delayed signals and the ground."""

import math

import numpy as np

from robots.description import Description
from worlds.hidden.effects.kind import HiddenKind, Quantity, Surroundings, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Setting
from worlds.soft_ground import DAMPING_RATIO, FootSpring


class _OnFeet(HiddenKind):
    """Hidden physics that only a robot standing on its feet can have."""

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the base is free, so that the robot stands on its feet."""
        return plant.floating


class CommandLatency(HiddenKind):
    """Commands reach all servos late, by a constant delay."""

    name = "command_latency"
    rank = 7
    place = "commands"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.06, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Make the commands later by the delay [s]."""
        surroundings.command_delay_s += values["delay"]


class SupplySag(HiddenKind):
    """The servos' supply loses voltage in proportion to the current that they take.

    Source: a source with an inner resistance; Hughes and Drury 2019, "Electric motors
    and drives".
    """

    name = "supply_sag"
    since = 5
    place = "supply"
    quantities = (Quantity("share", "1", 0.0, 0.9),)
    sizes = (0.5, 0.05)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Let the supply lose a share of its voltage at full load of all servos."""
        surroundings.sag_share += values["share"]

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has no limbs that hang on one supply but move apart."""
        return plant.floating or plant.description is None


class SensorDelay(_OnFeet):  # on a fixed base, late commands look the same
    """The readings of all encoders are late, by a constant delay."""

    name = "sensor_delay"
    rank = 8
    place = "encoders"
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    sizes = (0.04, 0.002)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Make the encoders' readings later by the delay [s]."""
        surroundings.encoder_delay_s += values["delay"]


class GyroBias(HiddenKind):
    """A constant error of the gyroscope, added to the true turning rate."""

    name = "gyro_bias"
    rank = 10
    place = "gyroscope"
    quantities = tuple(Quantity(axis, "rad/s", -5.0, 5.0) for axis in "xyz")

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Add the bias [rad/s] of each axis to the gyroscope's."""
        surroundings.gyroscope_bias_rad_s += [values[axis] for axis in "xyz"]

    def size(self, s: Setting) -> dict[str, float]:
        """Bias of 0.003 (hard to detect) to 0.05 rad/s (easy), randomly directed."""
        bias = s.part(0.05, 0.003) * s.direction
        return dict(zip("xyz", bias.tolist(), strict=True))

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has a gyroscope, as all robots with a description have."""
        return plant.description is not None


class ContactFriction(_OnFeet):
    """A friction coefficient between soles and ground other than the nominal one."""

    name = "contact_friction"
    rank = 21
    place = "feet"
    quantities = (Quantity("coefficient", "1", 0.0, 10.0),)
    sizes = (0.2, 0.6)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Set the friction coefficient between soles and ground."""
        surroundings.friction = values["coefficient"]


class ContactCompliance(_OnFeet):
    """Soft ground: a spring and damper under each foot."""

    name = "contact_compliance"
    rank = 22
    place = "feet"
    quantities = (
        Quantity("stiffness", "N/m", 1.0),
        Quantity("damping", "N s/m", 0.0, default=math.nan),
    )
    engines = ("bullet",)
    sizes = (3000.0, 40000.0)

    def foot_spring(self, values: Values, robot: Description) -> FootSpring:
        """Spring and damper under each foot; damping is 10 % of critical by default."""
        stiffness, damping = values["stiffness"], values["damping"]
        if math.isnan(damping):
            # Each foot carries half of the robot.
            damping = DAMPING_RATIO * 2 * np.sqrt(stiffness * (robot.mass_kg / 2))
        return FootSpring(stiffness, float(damping))


class GroundSlope(HiddenKind):
    """The ground, or a fixed base's mount, is tilted."""

    name = "ground_slope"
    rank = 23
    in_torques = True
    place = "world"
    quantities = (
        Quantity("pitch", "rad", -1.5, 1.5),
        Quantity("roll", "rad", -1.5, 1.5),
    )

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Tilt the ground, or a fixed base's mount, further by pitch and roll."""
        surroundings.pitch_rad += values["pitch"]
        surroundings.roll_rad += values["roll"]

    def size(self, s: Setting) -> dict[str, float]:
        """Tilt of 0.5 (hard to detect) to 4 degrees on feet, to 8 on a fixed base."""
        most_deg = 4.0 if s.plant.floating else 8.0
        tilt = math.radians(s.part(most_deg, 0.5))
        way = s.rng.uniform(0, 2 * math.pi)
        return {"pitch": tilt * math.cos(way), "roll": tilt * math.sin(way)}

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the robot has several joints; with one, tilt is an encoder offset."""
        return len(plant.joints) > 1


class UnevenGround(_OnFeet):
    """The ground has bumps."""

    name = "uneven_ground"
    rank = 24
    place = "world"
    quantities = (Quantity("height", "m", 0.0, 0.1),)
    sizes = (0.008, 0.0007)

    def change_surroundings(self, surroundings: Surroundings, values: Values) -> None:
        """Set the height of the bumps, unless they are higher already."""
        surroundings.bumps_m = max(surroundings.bumps_m, values["height"])
