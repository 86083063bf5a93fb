"""Frozen dataclasses as JSON and back, with unknown, missing and wrong parts refused.

The fields of such a dataclass may be numbers, text, true or false, paths, tuples,
mappings with text as keys, words out of a `Literal`, other dataclasses, or any of
these or None. Whatever is wrong in a file is told in one line that names the key.

Example:
  >>> from dataclasses import dataclass
  >>> @dataclass(frozen=True)
  ... class Size:
  ...     value: float
  ...     unit: str
  >>> to_plain(Size(2, "N"))
  {'value': 2.0, 'unit': 'N'}
  >>> from_plain(Size, {"value": 2, "unit": "N"}, "size")
  Size(value=2.0, unit='N')
"""

import json
import math
from collections.abc import Mapping
from typing import Any, NoReturn, TypeVar

from cattrs import AttributeValidationNote, IterableValidationNote
from cattrs.errors import BaseValidationError

from groundwalk.errors import BadValueError, GroundwalkError
from groundwalk.json_kinds import WrongPartError, converter, is_number

Kind = TypeVar("Kind")

NOT_IN_JSON: Mapping[str, bool] = {"json": False}
"""Metadata of a dataclass field with a default that JSON does not hold."""


def to_plain(value: Any) -> Any:
    """Turn a dataclass into dictionaries, lists, numbers and text, field by field.

    Numbers of fields declared as `float` become floats, NumPy's among them; paths
    become text.
    """
    return converter(True).unstructure(value)


def from_plain(
    kind: type[Kind], value: object, where: str, complete: bool = True
) -> Kind:
    """Make a dataclass of plain values; undoes `to_plain`.

    Args:
      kind: a dataclass, or any type that a field of one may have.
      value: plain values as `json.loads` gives them.
      where: how a message names the value, such as "verdict".
      complete: refuse keys that are missing even if their field has a default.

    Raises:
      BadValueError: a key is unknown or missing, or a value is of the wrong kind.
      GroundwalkError: whatever the dataclass itself raises for a value it refuses.
    """
    try:
        return converter(complete).structure(value, kind)
    except (BaseValidationError, WrongPartError) as error:
        raise _one_line(error, where) from None


def parse_json(text: str | bytes, where: str) -> Any:
    """Read JSON text, without NaN and infinities.

    Args:
      text: the text.
      where: how a message names it, such as "oracle".

    Raises:
      BadValueError: it is no JSON.
    """
    try:
        return json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise BadValueError(f"{where} is not JSON: {error}") from None


def parse_object(text: str | bytes, where: str, version: int) -> dict[str, object]:
    """Read JSON text that holds one object with a "format" key.

    Args:
      text: JSON without NaN and infinities.
      where: how a message names the text, such as "metadata".
      version: the only number that "format" may be.

    Returns:
      The object without its "format".

    Raises:
      BadValueError: it is no JSON, no object, or of another format.
    """
    plain = parse_json(text, where)
    if not isinstance(plain, dict):
        raise BadValueError(f"{where} must be a JSON object, not {plain!r}")
    if "format" not in plain:
        raise BadValueError(f"{where} has no 'format'; {version} is known")
    found = plain.pop("format")
    if isinstance(found, bool) or found != version:
        raise BadValueError(f"{where} 'format' is {found!r}; only {version} is known")
    return plain


def check_number(name: str, value: float, low: float, high: float = math.inf) -> None:
    """Refuse a value that is no finite number between two inclusive bounds.

    Args:
      name: how the message names the value.
      value: the number.
      low: the smallest number allowed.
      high: the largest number allowed.

    Raises:
      BadValueError: the value is no number, not finite or out of bounds.
    """
    if not (is_number(value) and low <= value <= high):
        span = f"from {low:g} to {high:g}" if high < math.inf else f"from {low:g} up"
        span = "" if low == -math.inf else f" {span}"
        raise BadValueError(f"{name} must be a finite number{span}, not {value!r}")


def _refuse_constant(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number")


def _one_line(error: BaseException, where: str) -> GroundwalkError:
    """The first error of a group, with the way to the key where it happened."""
    while isinstance(error, BaseValidationError):
        error = error.exceptions[0]
        for note in getattr(error, "__notes__", []):
            if isinstance(note, AttributeValidationNote):
                where = f"{where}.{note.name}"
            elif isinstance(note, IterableValidationNote):
                step = note.index
                where += f"[{step}]" if isinstance(step, int) else f".{step}"
    if isinstance(error, WrongPartError):
        return BadValueError(f"{where} {error}")
    if isinstance(error, BadValueError):
        return BadValueError(f"{where}: {error}")
    if isinstance(error, GroundwalkError):
        return error
    raise error
