"""Parts of an effect's description: parameters, places, words, a joint's motion."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from diagnosis.verdict.parts import PlacedEffect as PlacedEffect
from groundwalk.arrays import FloatArray

PlaceKind = Literal[
    "joint", "body", "feet", "commands", "encoders", "gyroscope", "world"
]
"""What an effect is attached to. All but joints and bodies exist once in a robot."""

Values = tuple[float, ...]
"""An effect's values in SI units, in the order of its parameters."""

Interval = tuple[float, float]
"""Start [s] and duration [s] of something that acts for a while."""

SIGN_SPEED_RAD_S = 0.02
"""Speed [rad/s] at which the smooth sign of a velocity reaches 76 %: faster than the
noise of a differentiated encoder, slower than any motion that shows friction."""


@dataclass(frozen=True)
class Parameter:
    """One number of an effect.

    Example:
      >>> Parameter("gap", "rad", low=0.0, high=0.15, neutral=0.0, typical=0.02)

    Attributes:
      name: what the number is called, for example "gap".
      unit: SI unit for a joint that turns; `Plant.unit` converts it for one that
        slides.
      low: smallest possible value.
      high: largest possible value.
      neutral: value at which the effect is absent; may be infinite.
      typical: value to try first.
      logarithmic: whether values are compared by their ratio.
    """

    name: str
    unit: str
    low: float
    high: float
    neutral: float
    typical: float
    logarithmic: bool = False


class EffectWords(NamedTuple):
    """Words that reports use for an effect.

    Example:
      >>> EffectWords("drag", "{body} meets a drag of {coefficient} {lacking}", "...")
    """

    label: str
    """Noun, for example "play (backlash)"."""
    finding: str
    """Clause about an effect that was found. In braces stand names of parameters, for
    which their values are put in, and `{joint}` or `{body}` for the place. `{lacking}`
    becomes "that the sim lacks" and `{usual}` "in the sim", or what replaces these
    where recordings of the healthy robot are the reference."""
    meaning: str
    """What the effect does, in one sentence."""

    @property
    def place_kind(self) -> str:
        """The placeholder for the place: "joint", "body", or "" if there is none."""
        kinds = ("joint", "body")
        return next((kind for kind in kinds if f"{{{kind}}}" in self.finding), "")


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Recorded motion of one joint, smoothed; arrays (rows,).

    Attributes:
      since_s: time since the start of the recording.
      position_rad: joint angle.
      velocity_rad_s: its rate.
      acceleration_rad_s2: rate of the velocity.
      command_rad: position target.
      command_rate_rad_s: rate of the position target.
      kp_nm_rad: stiffness of the servo.
      torque_nm: torque that the nominal model needs for this motion.
    """

    since_s: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    acceleration_rad_s2: FloatArray
    command_rad: FloatArray
    command_rate_rad_s: FloatArray
    kp_nm_rad: FloatArray
    torque_nm: FloatArray

    @property
    def direction(self) -> FloatArray:
        """(rows,) smooth sign of the velocity, between -1 and 1."""
        return np.asarray(np.tanh(self.velocity_rad_s / SIGN_SPEED_RAD_S))

    @property
    def pull_nm(self) -> FloatArray:
        """(rows,) torque of the servo's stiffness alone."""
        return np.asarray(self.kp_nm_rad * (self.command_rad - self.position_rad))
