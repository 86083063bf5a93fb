"""Converts frozen dataclasses to JSON and back, checking every key and value.

The fields of such a dataclass may be numbers, text, true or false, paths, tuples,
mappings with text as keys, words of a `Literal`, other dataclasses, or any of
these or None. An error message says in one line what is wrong and names the key.

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
"""`metadata` for a dataclass field that is left out of JSON; it needs a default."""


def to_plain(value: Any) -> Any:
    """Turn a dataclass into dictionaries, lists, numbers and text, field by field.

    A number in a field declared as `float` becomes a Python float, even if it is an int
    or a NumPy number; paths become text.
    """
    return converter(True).unstructure(value)


def from_plain(
    kind: type[Kind], value: object, where: str, complete: bool = True
) -> Kind:
    """Make a dataclass from dictionaries, lists, numbers and text; undoes `to_plain`.

    Args:
      kind: a dataclass, or any type that a field of one may have.
      value: the value as `json.loads` returns it.
      where: name of the value in error messages, such as "verdict".
      complete: refuse a missing key even if its field has a default.

    Raises:
      BadValueError: a key is unknown or missing, or a value is of the wrong kind.
      GroundwalkError: the dataclass itself refuses a value.
    """
    try:
        return converter(complete).structure(value, kind)
    except (BaseValidationError, WrongPartError) as error:
        raise _one_line(error, where) from None


def parse_json(text: str | bytes, where: str) -> Any:
    """Read JSON text, called `where` in error messages, such as "oracle".

    Raises:
      BadValueError: the text is not JSON, or it contains NaN or an infinity.
    """
    try:
        return json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise BadValueError(f"{where} is not JSON: {error}") from None


def parse_object(text: str | bytes, where: str, version: int) -> dict[str, object]:
    """Read JSON text that holds one object; the result lacks its "format" key.

    Raises:
      BadValueError: the text (called `where`, such as "metadata") is not JSON, contains
        NaN or an infinity, is no object, or its "format" is not this version.
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

    Raises:
      BadValueError: the value is no number, not finite or out of bounds; the message
        begins with its name.
    """
    if not (is_number(value) and low <= value <= high):
        span = f"from {low:g} to {high:g}" if high < math.inf else f"from {low:g} up"
        span = "" if low == -math.inf else f" {span}"
        raise BadValueError(f"{name} must be a finite number{span}, not {value!r}")


def _refuse_constant(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number")


def _one_line(error: BaseException, where: str) -> GroundwalkError:
    """One error from the first of cattrs' nested ones: "verdict.effects[2] ..."."""
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
