"""Answers to concealed test cases, of the diagnosis or of any other tool.

The format is that of docs/concealed_answers.md. A `diagnosis.json` is such an answer,
too; what it holds beyond is not read here.
"""

import json
import types
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

from groundwalk.errors import BadValueError
from groundwalk.json_data import check_number, from_plain, parse_object, to_plain

FORMAT = 1
AnswerKind = Literal["effects", "none", "unknown", "not_identifiable", "refused"]
"""What an answer says: which effects are missing; that none is; that something is which
it cannot name; that the recordings cannot tell; that it cannot work with them."""


@dataclass(frozen=True)
class Stated:
    """A value with the ends of its 80 % interval; None for ends that are not stated."""

    value: float
    low: float | None = None
    high: float | None = None

    def holds(self, value: float) -> bool:
        """Whether an interval is stated and holds a value."""
        ends = self.low, self.high
        return None not in ends and bool((ends[0] or 0.0) <= value <= (ends[1] or 0.0))


@dataclass(frozen=True)
class Which:
    """An effect at a place, such as "backlash" at "LKneePitch"."""

    name: str
    place: str


@dataclass(frozen=True)
class Named(Which):
    """An effect that an answer names, with the values of its parameters.

    `probability` is that of the name's being right, or None; each of `confusable_with`
    could be meant instead.
    """

    parameters: Mapping[str, Stated] = field(default_factory=dict)
    probability: float | None = None
    confusable_with: tuple[Which, ...] = ()

    def __post_init__(self) -> None:
        """Refuse probabilities outside of 0 to 1."""
        if self.probability is not None:
            check_number("probability", self.probability, 0.0, 1.0)


@dataclass(frozen=True)
class StatedErrors:
    """Errors on held-out data as an answer states them; None where it does not.

    `without` the main effect, and with it at a `wrong_place` or replaced by a
    `wrong_effect`.
    """

    nominal: float
    corrected: float
    without: float | None = None
    wrong_place: float | None = None
    wrong_effect: float | None = None


@dataclass(frozen=True)
class Answer:
    """What a tool says of a test case: see docs/concealed_answers.md.

    Attributes:
      kind: what the answer says.
      effects: the effects that it names, the most probable first.
      alternatives: other sets of effects that it does not rule out.
      fit: errors on held-out data, if stated.
      limits: sentences on what it cannot tell, or why it refuses; they are not scored.
    """

    kind: AnswerKind
    effects: tuple[Named, ...] = ()
    alternatives: tuple[tuple[Which, ...], ...] = ()
    fit: StatedErrors | None = None
    limits: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse answers that contradict themselves."""
        if self.kind == "effects" and not self.effects:
            raise BadValueError("an answer of kind 'effects' must name one at least")
        if self.kind == "none" and self.effects:
            raise BadValueError("an answer of kind 'none' must not name effects")

    def to_json(self) -> str:
        """The answer as JSON text."""
        plain = {"format": FORMAT, **to_plain(self)}
        return json.dumps(plain, indent=1, allow_nan=False) + "\n"


def read_answer(text: str) -> Answer:
    """Read an answer from JSON text; keys that `Answer` does not have are ignored.

    Raises:
      BadValueError: the text is no JSON, a key is missing, or a value is wrong.
    """
    plain = parse_object(text, "answer", FORMAT)
    return from_plain(Answer, _known(Answer, plain), "answer", complete=False)


def _known(kind: Any, plain: Any) -> Any:
    """A plain JSON value without the keys that dataclasses in `kind` do not have."""
    if get_origin(kind) in (Union, types.UnionType):
        (kind,) = (one for one in get_args(kind) if one is not type(None))
    if is_dataclass(kind) and isinstance(plain, dict):
        hints = get_type_hints(kind)
        names = [one.name for one in fields(kind)]
        return {
            name: _known(hints[name], plain[name]) for name in names if name in plain
        }
    if get_origin(kind) is tuple and isinstance(plain, list):
        return [_known(get_args(kind)[0], one) for one in plain]
    if get_origin(kind) is Mapping and isinstance(plain, dict):
        return {key: _known(get_args(kind)[1], one) for key, one in plain.items()}
    return plain
