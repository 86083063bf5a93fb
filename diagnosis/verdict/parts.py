"""The parts of a verdict: effects found, the mismatch, pulses and open questions."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from groundwalk.errors import BadValueError
from groundwalk.json_data import NOT_IN_JSON, check_number

Course = Literal["always", "burst", "drift"]
PulseSource = Literal["actuator input", "torque sensor", "position sensor"]
"""Origin of a `Pulse`, a torque that a servo did not ask for.

Example:
  >>> [pulse.joint for pulse in verdict.pulses if pulse.source == "torque sensor"]
"""


@dataclass(frozen=True)
class ValueRange:
    """A value with the ends of its 80 % interval.

    Raises:
      BadValueError: a number is not finite, or the value lies outside its interval.

    Example:
      >>> ValueRange(0.03, 0.027, 0.034).low
      0.027
    """

    value: float
    low: float
    high: float

    def __post_init__(self) -> None:
        """Refuse intervals outside of which their value lies."""
        for name in ("value", "low", "high"):
            check_number(name, getattr(self, name), -math.inf)
        if not self.low <= self.value <= self.high:
            raise BadValueError(
                f"value {self.value:g} must lie in its interval, "
                f"{self.low:g} to {self.high:g}"
            )


@dataclass(frozen=True)
class Estimate(ValueRange):
    """An estimate with the ends of its 80 % interval, and how it was checked.

    In 80 of 100 diagnoses the interval holds the true value.

    Attributes:
      nominal: the value at which the sim has nothing of the effect; None if that is
        infinite (as the stiffness of a rigid gear), or not known.
      recordings: what each recording says of it alone, by the recording's name; empty
        if there is only one, and without those that say nothing.
      starts: lowest and highest value at which fits ended that began at other values;
        None if there were none.

    Example:
      >>> Estimate(0.03, 0.027, 0.034, "rad").value
      0.03
    """

    unit: str
    nominal: float | None = None
    recordings: Mapping[str, ValueRange] = field(default_factory=dict)
    starts: tuple[float, float] | None = None


@dataclass(frozen=True)
class Amount:
    """A size, 0 or more, such as the smallest effect that the data could show.

    Example:
      >>> Amount(0.004, "rad").unit
      'rad'
    """

    value: float
    unit: str

    def __post_init__(self) -> None:
        """Refuse negative sizes."""
        check_number("value", self.value, 0.0)


@dataclass(frozen=True)
class PlacedEffect:
    """An effect (physics that a sim may lack) at a place, with or without values.

    Example:
      >>> PlacedEffect("backlash", "LKneePitch", (0.02,)).key
      'backlash@LKneePitch'
      >>> PlacedEffect.parse("drag@torso")
      PlacedEffect(name='drag', place='torso', values=())

    Attributes:
      name: name of the effect.
      place: joint, body, or the word for a place that exists once, such as "feet".
      values: values of the effect's parameters, in the order of its class and in SI
        units; empty where only effect and place matter. Not written to JSON.
      recording: the only recording in which it acted; None for all.
      tied: label of the effects of this name that share their values, since their
        joints have the same motor; empty for none.
    """

    name: str
    place: str
    values: tuple[float, ...] = field(default=(), metadata=NOT_IN_JSON)
    recording: str | None = field(default=None, metadata=NOT_IN_JSON)
    tied: str = field(default="", metadata=NOT_IN_JSON)

    @classmethod
    def parse(cls, key: str) -> "PlacedEffect":
        """The effect, without values, of a key such as "backlash@LKneePitch"."""
        name, _, place = key.partition("@")
        return cls(name, place)

    @property
    def key(self) -> str:
        """Effect and place, for example "backlash@LKneePitch"."""
        return f"{self.name}@{self.place}"


@dataclass(frozen=True)
class When:
    """When an effect acted: always, in a burst (for a while) or as a drift (growing).

    Bursts and drifts have a start and an end in the recording's time. `recording` is
    the name of the only one in which the effect acted, None if that is all of them.

    Example:
      >>> When("burst", 1.0, 2.5).end_s
      2.5
    """

    kind: Course = "always"
    start_s: float | None = None
    end_s: float | None = None
    recording: str | None = None

    def __post_init__(self) -> None:
        """Refuse bursts without times, and ends before their starts."""
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
    """An effect (physics that the sim lacks) that the recordings show.

    Attributes:
      place: where it is: a joint, a body, "feet", "commands", "supply" or "world".
      parameters: the estimates by the parameters' names.
      probability: probability from 0 to 1 that this is the right effect at the right
        place; None in a verdict "unknown", in which no effect is established.
      confusable_with: other effects, each of which could replace this one and explain
        the recordings about as well.
      when: whether it acts always, for a while, or growing.
      native: whether MuJoCo can simulate it, so that the corrected MJCF contains it.
      shared_with: other places at which the same effect has the same fitted values,
        as the recordings do not tell how they differ.

    Example:
      >>> Found("drag", "torso", {"coefficient": Estimate(2.0, 1.5, 2.5, "N s/m")}, 0.9)
    """

    name: str
    place: str
    parameters: Mapping[str, Estimate]
    probability: float | None
    confusable_with: tuple[PlacedEffect, ...] = ()
    when: When = When()
    native: bool = True
    shared_with: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse probabilities outside of 0 to 1."""
        if self.probability is not None:
            check_number("probability", self.probability, 0.0, 1.0)


@dataclass(frozen=True)
class MismatchCell:
    """The error of the nominal sim in one channel of the recordings.

    Attributes:
      channel: name of the channel, such as "position.LKneePitch".
      share: this channel's share, 0 to 1, of the squared error of all channels that
        noise does not explain, with each channel in units of its noise.
      error_rms: rms difference of recording and sim.
      noise_rms: rms of the sensor's noise.
      regimes: rms error as a multiple of the noise in rows of one kind of motion, by
        its name, such as "reversals" or "fast".
      bursts: times (start, end) [s] during which the error stands out.

    Example:
      >>> MismatchCell("position.knee", "rad", 0.8, 0.02, 0.001, {"fast": 25.0}).share
      0.8
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
    """A constant torque, for a while, that a joint's servo did not ask for.

    Start and end are in the recording's time.

    Attributes:
      torque: measured torque less the torque that the servo asked for.
      source: origin of the pulse. "actuator input": a real torque, which moves the
        joint. "torque sensor": only the sensor showed it. "position sensor": the
        measured position jumped, and the servo's expected torque with it.
      jumps: mean jump at the edges of the joint's pulses, as a share of the pulse, by
        signal ("torque", "position", "command").
      felt: share of the pulse's torque that, by inverse dynamics, moved the joint;
        0 if the measured torque has no pulse.

    Example:
      >>> pulse = verdict.pulses[0]
      >>> pulse.joint, pulse.torque, pulse.end_s - pulse.start_s
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
        """Refuse pulses that end before they start."""
        check_number("start of a pulse", self.start_s, -math.inf)
        check_number("end of a pulse", self.end_s, self.start_s)
        for name in ("torque", "felt"):
            check_number(name, getattr(self, name), -math.inf)
        for name, value in self.jumps.items():
            check_number(f"jump of {name}", value, -math.inf)


@dataclass(frozen=True)
class Unexplained:
    """The shape of an error that no known effect explains.

    It is the curve of a channel's mean error over another quantity, in bins.

    Attributes:
      share: share of the squared error above the noise that remains, 0 to 1.
      channel: the channel in which the remaining error is largest.
      against: the other quantity, such as "position.LKneePitch".
      at: middle of each bin.
      mean: mean of measured less simulated values in each bin, in `unit`.
      spread: standard error of each mean, in `unit`.

    Example:
      >>> rest = verdict.unexplained
      >>> rest.channel, max(rest.mean), rest.unit
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
        """Refuse curves whose `at`, `mean` and `spread` differ in length."""
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
    """The recording that would best decide what is still open: of one joint, or of all.

    Example:
      >>> NextExperiment("chirp", "LKneePitch", "two effects are left").joint
      'LKneePitch'
    """

    motion: str
    joint: str | None
    why: str


@dataclass(frozen=True)
class Recordings:
    """Names of the recordings, or of parts of them, by their use.

    Parameters are fitted to `fit`, `select` decides between fitted models, and `test`
    gives the final errors.

    Example:
      >>> Recordings(fit=("a",), select=("b",), test=("c",)).test
      ('c',)
    """

    fit: tuple[str, ...] = ()
    select: tuple[str, ...] = ()
    test: tuple[str, ...] = ()
