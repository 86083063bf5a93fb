"""Types that effects use: parameters, kinds of places, words, motion of a joint."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from diagnosis.verdict import PlacedEffect as PlacedEffect
from groundwalk.arrays import FloatArray

PlaceKind = Literal[
    "joint", "body", "feet", "commands", "encoders", "gyroscope", "supply", "world"
]
"""Kind of thing that an effect is attached to. A robot has several joints and bodies,
but each of the other things once."""

Variety = Literal["speeds", "reversals", "poses", "accelerations"]
"""What a joint's motion must have much of to show an effect as itself."""

Values = tuple[float, ...]
"""An effect's values in SI units, in the order of its parameters."""

EARLIEST_S, LONGEST_S = -2.0, 600.0
"""Bounds of an effect that does not last: earliest start, in the recording's time, and
longest duration. It may have begun before the recording."""


class Interval(NamedTuple):
    """Start [s] and duration [s] of an effect that does not last.

    Attributes:
      recording: name of the only recording in which it acts; None for all.
    """

    start_s: float
    duration_s: float
    recording: str | None = None


SIGN_SPEED_RAD_S = 0.02
"""Speed [rad/s] at which the smooth sign tanh(v / speed) of a velocity v reaches 76 %:
above the noise of a differentiated encoder, below any motion that shows friction."""


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect: its name, unit, bounds and usual value.

    Example:
      >>> Parameter("gap", "rad", low=0.0, high=0.15, neutral=0.0, typical=0.02)

    Attributes:
      unit: SI unit for a hinge joint; `Plant.unit` converts it for a sliding joint.
      low: smallest possible value.
      high: largest possible value.
      neutral: value at which the effect is absent; may be infinite.
      typical: value to try first.
      logarithmic: whether values are compared by ratio instead of difference.
      full: whether `high` is all that there is, a value like any other, not a guess of
        what is possible.
    """

    name: str
    unit: str
    low: float
    high: float
    neutral: float
    typical: float
    logarithmic: bool = False
    full: bool = False


class EffectWords(NamedTuple):
    """Words that reports use for an effect.

    Attributes:
      label: noun for the effect, for example "play (backlash)".
      finding: clause about an effect that was found. Parameter names in braces stand
        for values, `{joint}` or `{body}` for the place, `{lacking}` for "that the sim
        lacks" and `{usual}` for "in the sim"; the last two have other words where
        recordings of the healthy robot are the reference.
      meaning: explanation for a reader of the report, in one sentence.
      advice: what to look at or to do at the robot, in one sentence; "" for nothing.
      below: clause where the first value is below 0, which is said without its sign; ""
        for the same as `finding`.

    Example:
      >>> EffectWords("water drag", "{joint} has {coefficient} of drag {lacking}", "")
    """

    label: str
    finding: str
    meaning: str
    advice: str = ""
    below: str = ""

    @property
    def place_kind(self) -> str:
        """Placeholder for the place in `finding`: "joint", "body", or "" if none."""
        kinds = ("joint", "body")
        return next((kind for kind in kinds if f"{{{kind}}}" in self.finding), "")


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Recorded motion of one joint, smoothed; arrays (rows,).

    Commands are position targets, `kp_nm_rad` is the servo's stiffness, and `torque_nm`
    the torque for this motion by inverse dynamics of the nominal model.

    Example:
      >>> def torque_column(self, motion: JointMotion) -> FloatArray:
      ...     return -motion.direction  # of an effect: dry friction of 1 N m
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
        """(rows,) sign of the velocity, smoothed near 0, between -1 and 1."""
        return np.asarray(np.tanh(self.velocity_rad_s / SIGN_SPEED_RAD_S))

    @property
    def pull_nm(self) -> FloatArray:
        """(rows,) torque [N m] of the servo's stiffness alone: kp (command - angle)."""
        return np.asarray(self.kp_nm_rad * (self.command_rad - self.position_rad))
