"""Hidden faults of a joint's encoder: ripple, wrong samples, readings that are late."""

import math

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Servos
from worlds.hidden.setting import Setting


class PositionRipple(HiddenKind):
    """An error of the encoder that repeats with the angle; the servo acts on it.

    The reading is q + amplitude sin(per_turn q + phase) at joint angle q. An eccentric
    magnet or disc errs once and twice a turn, by up to some 10 mrad (Hanselman 1990,
    "Resolver signal requirements for high accuracy resolver-to-digital conversion");
    gears add errors of 0.1 to 2 mrad at their teeth's and wave generators' harmonics
    (Ghorbel, Gandhi and Alpeter 2001, "On the kinematic error in harmonic drive
    gears").
    """

    name = "position_ripple"
    rank = 33
    since = 2
    in_torques = True
    quantities = (
        Quantity("amplitude", "rad", 0.0, 0.5),
        Quantity("per_turn", "1", 0.0),
        Quantity("phase", "rad"),
    )
    outside = True
    needs_motion = True

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Add the periodic error to what the joint's encoder reads."""
        ripple = values["amplitude"], values["per_turn"], values["phase"]
        servos.ripples.append((joint, *ripple))

    def size(self, s: Setting) -> dict[str, float]:
        """Amplitude of 0.5 (hard to detect) to 20 mrad (easy), 4 to 40 times a turn.

        Where a joint moves by a radian, fewer would look like an offset and a gain. The
        slope of the error stays below a half, so that the servo remains stable.
        """
        per_turn = round(math.exp(s.rng.uniform(math.log(4), math.log(40))))
        return {
            "amplitude": min(s.part(0.02, 0.0005), 0.5 / per_turn),
            "per_turn": float(per_turn),
            "phase": float(s.rng.uniform(0, 2 * math.pi)),
        }


class EncoderOutliers(HiddenKind):
    """Single readings of a joint's encoder are wrong; the servo's own are not.

    Rows are hit at random, `rate` per second on average, and read too much or too
    little by `jump`: bits that flip on the bus. In logs of cheap servos they come some
    times an hour to some times a second.
    """

    name = "encoder_outliers"
    rank = 34
    since = 2
    in_torques = True
    quantities = (
        Quantity("rate", "1/s", 0.0),
        Quantity("jump", "rad", 0.0, 7.0),
    )
    outside = True

    def misread(
        self,
        values: Values,
        time_s: FloatArray,
        angle_rad: FloatArray,
        rng: np.random.Generator,
    ) -> FloatArray:
        """Shift single rows by the jump, to either side."""
        chance = np.minimum(values["rate"] * np.gradient(time_s), 1.0)
        hit = rng.uniform(size=len(time_s)) < chance
        sign = rng.choice([-1.0, 1.0], len(time_s))
        return np.asarray(angle_rad + np.where(hit, sign * values["jump"], 0.0))

    def size(self, s: Setting) -> dict[str, float]:
        """Jumps of 0.5 mrad (hard to detect) to 0.4 rad (easy), once in 0.5 to 3 s."""
        return {
            "rate": 1.0 / float(s.rng.uniform(0.5, 3.0)),
            "jump": s.part(0.4, 0.0005),
        }


class LateReading(HiddenKind):
    """The readings of one joint are older than those of the others.

    The row at time t holds q(t - delay); the servo acts on its own, fresh reading. A
    bus that asks one servo after the other takes 0.2 to 5 ms for each, and repeats
    requests that fail.
    """

    name = "late_reading"
    rank = 35
    since = 2
    in_torques = True
    quantities = (Quantity("delay", "s", 0.0, 0.5),)
    outside = True
    needs_motion = True
    sizes = (0.03, 0.0003)

    def change_servos(self, servos: Servos, joint: int, values: Values) -> None:
        """Make the joint's readings older by the delay [s]."""
        servos.late_s[joint] += values["delay"]

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether other joints tell the time: with one, the commands seem late."""
        return len(plant.joints) > 1
