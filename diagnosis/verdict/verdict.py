"""The answer of a diagnosis, and its file `diagnosis.json` (docs/diagnosis_json.md)."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from diagnosis.verdict.parts import (
    Amount,
    Found,
    MismatchCell,
    NextExperiment,
    PlacedEffect,
    Pulse,
    Recordings,
    Unexplained,
)
from groundwalk.errors import BadValueError
from groundwalk.json_data import check_number, from_plain, parse_object, to_plain


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Rms errors of simulations on held-out recordings; None if not computed.

    `without`, `wrong_place` and `wrong_effect` show the error of wrong answers; there,
    the main effect is the found effect that reduces the error most.

    Attributes:
      nominal, corrected: errors of the sims without and with the effects found.
      floor: the measured noise, or the accuracy of simulation and clocks if larger.
      ceiling: error of a flexible regression without physics.
      without: error without the main effect, the others refitted.
      wrong_place: error with the main effect moved to the best other place.
      wrong_effect: error with the main effect replaced by one drawn at random.

    Example:
      >>> Errors(nominal=5.0, corrected=1.2, floor=1.0).closed(1.2)
      0.95
    """

    nominal: float
    corrected: float
    floor: float
    ceiling: float | None = None
    without: float | None = None
    wrong_place: float | None = None
    wrong_effect: float | None = None

    def __post_init__(self) -> None:
        """Refuse negative errors."""
        for name in Errors.__dataclass_fields__:
            value = getattr(self, name)
            if value is not None:
                check_number(name, value, 0.0)

    @property
    def excess(self) -> float:
        """The error of the nominal sim as a multiple of the noise floor."""
        if self.floor > 0:
            return self.nominal / self.floor
        return math.inf if self.nominal > 0 else 0.0

    def closed(self, error: float | None) -> float | None:
        """Share of the nominal sim's error above the noise floor that is removed.

        It is 1 if the error that remains is down to the floor, 0 if it is the nominal
        sim's; None if that is no worse than the noise, or `error` is None.
        """
        if error is None or self.nominal <= self.floor:
            return None
        return (self.nominal - error) / (self.nominal - self.floor)


@dataclass(frozen=True, kw_only=True)
class ChannelFit(Errors):
    """Rms errors of simulations in one channel of held-out recordings, in its `unit`.

    Example:
      >>> ChannelFit(nominal=5.0, corrected=1.2, floor=1.0, unit="rad").excess
      5.0
    """

    unit: str


@dataclass(frozen=True, kw_only=True)
class Fit(Errors):
    """Errors of simulations over all channels together, as multiples of noise floors.

    An error is the root of the mean over channels of (rms error / noise floor) squared.

    Example:
      >>> Fit(nominal=5.0, corrected=1.2, floor=1.0, channels={}).closed(1.2)
      0.95
    """

    channels: Mapping[str, ChannelFit]


FORMAT = 1
VerdictKind = Literal["effects", "none", "unknown", "not_identifiable"]
"""The answer of a diagnosis in one word. `Verdict` explains each.

Example:
  >>> verdict.kind
  'effects'
"""


@dataclass(frozen=True)
class Verdict:
    """Which physics the sim lacks, how sure that is, and what remains open.

    Attributes:
      kind: "effects": the sim lacks the effects named. "none": the data show nothing
        missing. "unknown": an error remains that no effect of the library explains.
        "not_identifiable": something may be missing, but these data cannot name it.
      effects: the effects found, the most probable first; a verdict of kind "unknown"
        may have some, too.
      small: effects found that are no larger than robots usually differ from their
        models: the corrected sim has them, but they are no evidence of missing physics.
      alternatives: other sets of effects that these data do not rule out.
      smallest_detectable: smallest size of each effect that these data could have
        shown, by "effect@place".
      unexplained: the shape of an error that no effect explains.
      limits: sentences on what these data cannot show.
      mismatch: where and when the nominal sim errs, the worst channel first.
      pulses: torques that servos did not ask for, in the order of time.
      fit: errors of nominal and corrected sim on held-out data.
      next_experiment: what to record next; None if nothing is open.
      tried: number of effects at their places that were compared; None if unknown.
      seconds: duration of the diagnosis.

    Example:
      >>> Verdict.from_json(Verdict("none").to_json()).kind
      'none'
    """

    kind: VerdictKind
    effects: tuple[Found, ...] = ()
    small: tuple[Found, ...] = ()
    alternatives: tuple[tuple[PlacedEffect, ...], ...] = ()
    smallest_detectable: Mapping[str, Amount] = field(default_factory=dict)
    unexplained: Unexplained | None = None
    limits: tuple[str, ...] = ()
    mismatch: tuple[MismatchCell, ...] = ()
    pulses: tuple[Pulse, ...] = ()
    fit: Fit | None = None
    next_experiment: NextExperiment | None = None
    recordings: Recordings = field(default_factory=Recordings)
    tried: int | None = None
    seconds: float = 0.0

    def __post_init__(self) -> None:
        """Refuse verdicts that contradict themselves.

        Raises:
          BadValueError: the kind does not fit what was found.
        """
        check_number("seconds", self.seconds, 0.0)
        for key in self.smallest_detectable:
            if "@" not in key:
                raise BadValueError(f"smallest_detectable has {key!r}: 'effect@place'")
        if self.kind == "effects" and not self.effects:
            raise BadValueError("a verdict of kind 'effects' must name one at least")
        if self.kind == "none" and self.effects:
            raise BadValueError("a verdict of kind 'none' must not name effects")
        if self.kind == "unknown" and self.unexplained is None:
            raise BadValueError("a verdict of kind 'unknown' must show 'unexplained'")
        if self.kind == "not_identifiable" and not (self.alternatives or self.limits):
            raise BadValueError(
                "a verdict of kind 'not_identifiable' must say why: it needs "
                "'alternatives' or 'limits'"
            )

    def to_json(self) -> str:
        """The verdict as JSON text; the same verdict gives the same text."""
        plain = {"format": FORMAT, **to_plain(self)}
        return json.dumps(plain, indent=1, allow_nan=False, ensure_ascii=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Verdict":
        """Read the JSON text of a verdict, as `to_json` writes it.

        Raises:
          BadValueError: the text is no JSON or has another format, a key is missing or
            unknown, or a value is wrong.
        """
        plain = parse_object(text, "verdict", FORMAT)
        _add_later_keys(plain)
        return from_plain(cls, plain, "verdict")


def _add_later_keys(plain: dict[str, Any]) -> None:
    """Add keys that the first verdicts did not have, with values that say nothing."""
    for key, nothing in (("pulses", []), ("small", []), ("tried", None)):
        plain.setdefault(key, nothing)
    for kind in ("effects", "small"):
        effects = plain.get(kind)
        for one in effects if isinstance(effects, list) else []:
            if not isinstance(one, dict):
                continue
            one.setdefault("shared_with", [])
            parameters = one.get("parameters")
            every = parameters.values() if isinstance(parameters, dict) else ()
            for value in every:
                if isinstance(value, dict):
                    value.setdefault("nominal", None)
                    value.setdefault("recordings", {})
                    value.setdefault("starts", None)
