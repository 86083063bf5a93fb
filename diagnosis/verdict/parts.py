"""What a verdict is made of: effects found, the mismatch, and what is open."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from groundwalk.errors import BadValueError
from groundwalk.json_data import NOT_IN_JSON, check_number

Course = Literal["always", "burst", "drift"]
PulseSource = Literal["actuator input", "torque sensor", "position sensor"]


@dataclass(frozen=True)
class Estimate:
    """A number with the interval that holds it in 80 of 100 diagnoses."""

    value: float
    low: float
    high: float
    unit: str

    def __post_init__(self) -> None:
        """Refuse intervals that do not hold their value."""
        for name in ("value", "low", "high"):
            check_number(name, getattr(self, name), -math.inf)
        if not self.low <= self.value <= self.high:
            raise BadValueError(
                f"value {self.value:g} must lie in its interval, "
                f"{self.low:g} to {self.high:g}"
            )


@dataclass(frozen=True)
class Amount:
    """A size with its unit, such as the least that could have been seen."""

    value: float
    unit: str

    def __post_init__(self) -> None:
        """Refuse sizes below nothing."""
        check_number("value", self.value, 0.0)


@dataclass(frozen=True)
class PlacedEffect:
    """An effect at a place, with or without values.

    Example:
      >>> PlacedEffect("backlash", "LKneePitch", (0.02,)).key
      'backlash@LKneePitch'
      >>> PlacedEffect.parse("drag@torso")
      PlacedEffect(name='drag', place='torso', values=())

    Attributes:
      name: of the effect.
      place: joint, body, or the word for a place that exists once, such as "feet".
      values: of all its parameters, in their order and in SI units; empty where only
        effect and place matter. Not written to JSON.
    """

    name: str
    place: str
    values: tuple[float, ...] = field(default=(), metadata=NOT_IN_JSON)

    @classmethod
    def parse(cls, key: str) -> "PlacedEffect":
        """The effect without values whose `key` is given."""
        name, _, place = key.partition("@")
        return cls(name, place)

    @property
    def key(self) -> str:
        """Effect and place, for example "backlash@LKneePitch"."""
        return f"{self.name}@{self.place}"


@dataclass(frozen=True)
class When:
    """When an effect acted; a burst and a drift have times of the recording [s]."""

    kind: Course = "always"
    start_s: float | None = None
    end_s: float | None = None

    def __post_init__(self) -> None:
        """Refuse bursts without times, and times that run backwards."""
        if self.kind == "always":
            if (self.start_s, self.end_s) != (None, None):
                raise BadValueError("what acts always has no start_s and no end_s")
            return
        if self.start_s is None or self.end_s is None:
            raise BadValueError(f"a {self.kind} needs start_s and end_s")
        check_number("start_s", self.start_s, -math.inf)
        check_number("end_s", self.end_s, self.start_s)


@dataclass(frozen=True)
class Found:
    """An effect that the recordings show.

    Attributes:
      name: of the effect.
      place: where it is.
      parameters: what was estimated, by the parameter's name.
      probability: that this is the right effect at the right place, 0 to 1, calibrated
        on concealed cases (`diagnosis.conclude.confidence`).
      confusable_with: what else would explain the same, alone in its stead.
      when: all the time, for a while, or growing.
      native: whether MuJoCo has this physics, so that the corrected MJCF holds it.
    """

    name: str
    place: str
    parameters: Mapping[str, Estimate]
    probability: float
    confusable_with: tuple[PlacedEffect, ...] = ()
    when: When = When()
    native: bool = True

    def __post_init__(self) -> None:
        """Refuse what is no probability."""
        check_number("probability", self.probability, 0.0, 1.0)


@dataclass(frozen=True)
class MismatchCell:
    """How far the nominal sim is from one channel of the recordings.

    Attributes:
      channel: such as "position.LKneePitch" or "gyroscope.x".
      unit: of the two errors.
      share: of the squared error of all channels that noise does not explain, each in
        units of its noise, 0 to 1.
      error_rms: real less sim.
      noise_rms: what the sensor's noise alone makes.
      regimes: rms error as a multiple of the noise, in parts of the data such as
        "reversals" or "fast".
      bursts: times (start, end) [s] at which the error stands out.
    """

    channel: str
    unit: str
    share: float
    error_rms: float
    noise_rms: float
    regimes: Mapping[str, float]
    bursts: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        """Refuse negative errors, and bursts that run backwards."""
        check_number("share", self.share, 0.0, 1.0)
        check_number("error_rms", self.error_rms, 0.0)
        check_number("noise_rms", self.noise_rms, 0.0)
        for name, value in self.regimes.items():
            check_number(f"regime {name!r}", value, 0.0)
        for start_s, end_s in self.bursts:
            check_number("start of a burst", start_s, -math.inf)
            check_number("end of a burst", end_s, start_s)


@dataclass(frozen=True)
class Pulse:
    """A torque that a joint's servo did not ask for, for a while.

    Attributes:
      recording: its name.
      joint: at which.
      start_s: in the recording's time.
      end_s: likewise.
      torque: measured less what the servo asked for.
      unit: of the torque.
      source: where it came in. "actuator input": it was real, the motion obeys it.
        "torque sensor": the joint never felt it. "position sensor": the measured
        position jumped, so that the servo seems to be wrong.
      jumps: at the edges of the joint's pulses, by signal ("torque", "position",
        "command"), as a share of the pulse.
      felt: share of the measured torque that the motion obeys; 0 where the pulse is
        not in the torque.
    """

    recording: str
    joint: str
    start_s: float
    end_s: float
    torque: float
    unit: str
    source: PulseSource
    jumps: Mapping[str, float]
    felt: float

    def __post_init__(self) -> None:
        """Refuse pulses that run backwards."""
        check_number("start of a pulse", self.start_s, -math.inf)
        check_number("end of a pulse", self.end_s, self.start_s)
        for name in ("torque", "felt"):
            check_number(name, getattr(self, name), -math.inf)
        for name, value in self.jumps.items():
            check_number(f"jump of {name}", value, -math.inf)


@dataclass(frozen=True)
class Unexplained:
    """An error with a shape that no effect of the library makes.

    The curve is the mean error of a channel over another quantity, bin by bin.

    Attributes:
      share: of the squared error above noise that is left.
      channel: in which it is largest.
      unit: of that channel.
      against: the quantity, such as "position.LKneePitch".
      against_unit: its unit.
      at: middles of the bins.
      mean: error of the corrected sim in each bin.
      spread: standard error of each mean.
    """

    share: float
    channel: str
    unit: str
    against: str
    against_unit: str
    at: tuple[float, ...]
    mean: tuple[float, ...]
    spread: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse curves of unequal lengths."""
        check_number("share", self.share, 0.0, 1.0)
        if not len(self.at) == len(self.mean) == len(self.spread):
            raise BadValueError(
                f"at, mean and spread must be of one length, not {len(self.at)}, "
                f"{len(self.mean)} and {len(self.spread)}"
            )
        for value in (*self.at, *self.mean, *self.spread):
            check_number("a value of the curve", value, -math.inf)


@dataclass(frozen=True)
class NextExperiment:
    """The recording that would tell most: a motion, of a joint or of all, and why."""

    motion: str
    joint: str | None
    why: str


@dataclass(frozen=True)
class Recordings:
    """Names of recordings, or parts of them, by what they were used for."""

    fit: tuple[str, ...] = ()
    select: tuple[str, ...] = ()
    test: tuple[str, ...] = ()
