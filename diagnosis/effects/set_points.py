"""Effects of firmware that limits the speed or the acceleration of set-points.

How replays move a set-point under both limits is in `replay.set_points`.
"""

import numpy as np

from diagnosis.effects.base_kinds import CommandedServo, NumberEffect
from diagnosis.effects.parts import EffectWords, Parameter, Values
from diagnosis.effects.scales import speed_rad_s
from diagnosis.plant.plant import Plant
from diagnosis.traces.usage import Usage

RISES_S = (0.05, 0.2, 0.8)
"""Times [s] in which set-points that are tried first reach the joint's highest speed.
From 0.02 to 2 s none is further from one of them than a factor of 2.5 (`STRETCHES`)."""


class SpeedLimit(NumberEffect, CommandedServo):
    """A set-point that follows the command no faster than a limit.

    Source: rate limiter, Astrom and Hagglund 2006, "Advanced PID control";
    hobby and smart servos have it as their "moving speed".
    """

    name = "speed_limit"
    shown_by = "speeds"
    native = False
    threshold = True
    quantity = "setpoint_speed_rad_s"
    combined = np.minimum
    words = EffectWords(
        "speed limit",
        "the servo of {joint} moves its target no faster than {speed}, unlike {usual}",
        "A setting in the servo's firmware that slows its target down.",
        "Look at the servo's setting for its moving speed or profile.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The limit [rad/s]: 1 % to 4 times the motor's no-load speed."""
        scale = speed_rad_s(plant, place)
        low, typical, high = 0.01 * scale, 0.4 * scale, 4 * scale
        return (Parameter("speed", "rad/s", low, high, np.inf, typical, True),)

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Limits of 2, 1.4, 1 and 0.7 times the joint's highest speed.

        A target that is limited takes the joint along, so that the joint's own speed
        tells the limit; that of commands, which may jump, does not.
        """
        speed = usage.top_speed_rad_s[plant.joints.index(place)]
        return [(factor * speed,) for factor in (2.0, 1.4, 1.0, 0.7)]


class AccelerationLimit(NumberEffect, CommandedServo):
    """A set-point that speeds up and slows down no faster than a limit.

    Where the command jumps, it reaches it by a ramp, or trapezoid, of speed.

    Source: Biagiotti and Melchiorri 2008, "Trajectory planning for automatic machines
    and robots", section 3.2; smart servos have it as "acceleration" (Feetech, "STS
    series memory table", address 41, 0.15 to 39 rad/s^2) or "profile acceleration".
    """

    name = "acceleration_limit"
    shown_by = "accelerations"
    native = False
    threshold = True
    quantity = "setpoint_acceleration_rad_s2"
    combined = np.minimum
    words = EffectWords(
        "limited acceleration of the target",
        "the servo of {joint} changes the speed of its target by no more than "
        "{acceleration}, unlike {usual}",
        "A setting in the servo's firmware that lets its target start and stop gently.",
        "Look at the servo's setting for its acceleration or profile.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The limit [rad/s^2]: the motor's no-load speed in 100 s to 5 ms."""
        scale = speed_rad_s(plant, place)
        low, typical, high = 0.01 * scale, 5 * scale, 200 * scale
        unit = "rad/s^2"
        return (Parameter("acceleration", unit, low, high, np.inf, typical, True),)

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """Limits [rad/s^2] with which the joint's highest speed takes `RISES_S`."""
        (limit,) = self.parameters(plant, place)
        speed = float(usage.top_speed_rad_s[plant.joints.index(place)])
        return [(max(speed / rise_s, limit.low),) for rise_s in RISES_S]
