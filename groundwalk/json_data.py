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
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache, partial
from numbers import Integral, Real
from pathlib import Path
from types import UnionType
from typing import Any, Literal, NoReturn, TypeVar, Union, get_args, get_origin

from cattrs import AttributeValidationNote, Converter, IterableValidationNote
from cattrs.cols import (
    homogenous_tuple_structure_factory,
    is_mapping,
    mapping_structure_factory,
)
from cattrs.errors import BaseValidationError
from cattrs.gen import (
    make_dict_structure_fn,
    make_dict_unstructure_fn,
    make_hetero_tuple_structure_fn,
    override,
)

from groundwalk.errors import BadValueError, GroundwalkError, UnknownNameError

Kind = TypeVar("Kind")
Hook = Callable[[Any, Any], Any]


NOT_IN_JSON: Mapping[str, bool] = {"json": False}
"""Metadata of a dataclass field with a default that JSON does not hold."""


class _WrongPartError(BadValueError):
    """A message that still lacks its subject: the key at which it happened."""


def to_plain(value: Any) -> Any:
    """A dataclass as dictionaries, lists, numbers and text, field by field.

    Numbers of fields declared as `float` become floats, NumPy's among them; paths
    become text.
    """
    return _converter(True).unstructure(value)


def from_plain(
    kind: type[Kind], value: object, where: str, complete: bool = True
) -> Kind:
    """Make again what `to_plain` has turned into plain values.

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
        return _converter(complete).structure(value, kind)
    except (BaseValidationError, _WrongPartError) as error:
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
    if not (_is_number(value) and low <= value <= high):
        span = f"from {low:g} to {high:g}" if high < math.inf else f"from {low:g} up"
        span = "" if low == -math.inf else f" {span}"
        raise BadValueError(f"{name} must be a finite number{span}, not {value!r}")


def _refuse_constant(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number")


def _is_number(value: Any) -> bool:
    try:
        is_real = isinstance(value, Real) and not isinstance(value, bool)
        return is_real and math.isfinite(value)
    except OverflowError:  # a whole number beyond all floats
        return False


def _is_whole(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)


_SCALARS: Mapping[type, tuple[str, Callable[[Any], bool]]] = {
    float: ("a finite number", _is_number),
    int: ("a whole number", _is_whole),
    str: ("text", lambda value: isinstance(value, str)),
    bool: ("true or false", lambda value: isinstance(value, bool)),
    Path: ("text", lambda value: isinstance(value, str)),
}
"""What messages call each kind of single value, and how it is recognised."""


@cache
def _converter(complete: bool) -> Converter:
    """A cattrs converter whose hooks check kinds and keys before they convert."""
    converter = Converter(unstruct_collection_overrides={tuple: list})
    converter.register_unstructure_hook(float, float)
    converter.register_unstructure_hook(Path, str)
    converter.register_unstructure_hook_factory(is_dataclass, _unstructure_hook)
    for scalar, (wanted, is_right) in _SCALARS.items():
        check = partial(_check, wanted=wanted, is_right=is_right)
        converter.register_structure_hook(scalar, _checked(check, _call))
    for matches, factory in (
        (_is_choice, lambda kind, _: lambda value, _: value),
        (_is_literal, _literal_hook),
        (_is_tuple, _tuple_hook),
        (is_mapping, _mapping_hook),
        (is_dataclass, partial(_dataclass_hook, complete)),
    ):
        converter.register_structure_hook_factory(matches, factory)
    return converter


def _is_choice(kind: Any) -> bool:
    """Whether a type is `object`, or a union of several types besides None.

    The dataclass checks such a value by itself: it is passed on as it is.
    """
    parts = set(get_args(kind)) - {type(None)}
    return kind is object or (get_origin(kind) in (Union, UnionType) and len(parts) > 1)


def _is_literal(kind: Any) -> bool:
    return get_origin(kind) is Literal


def _is_tuple(kind: Any) -> bool:
    return get_origin(kind) is tuple


def _literal_hook(kind: Any, _: Converter) -> Hook:
    words = get_args(kind)
    return _checked(
        partial(_check, wanted=" or ".join(words), is_right=lambda one: one in words),
        lambda value, _: value,
    )


def _mapping_hook(kind: Any, converter: Converter) -> Hook:
    return _checked(_check_object, mapping_structure_factory(kind, converter))


def _tuple_hook(kind: Any, converter: Converter) -> Hook:
    parts = get_args(kind)

    def check(value: Any) -> None:
        _check(value, "a list", lambda one: isinstance(one, list))
        if parts[-1] is not ...:
            wanted = f"a list of {len(parts)}"
            _check(value, wanted, lambda one: len(one) == len(parts))

    if parts[-1] is ...:
        return _checked(check, homogenous_tuple_structure_factory(kind, converter))
    return _checked(check, make_hetero_tuple_structure_fn(kind, converter))


def _dataclass_hook(complete: bool, kind: Any, converter: Converter) -> Hook:
    held = [field for field in fields(kind) if field.metadata.get("json", True)]
    known = [field.name for field in held]
    needed = [
        field.name
        for field in held
        if complete or (field.default is MISSING and field.default_factory is MISSING)
    ]

    def check(value: Any) -> None:
        _check_object(value)
        for key in value:
            if key not in known:
                raise _WrongPartError(f"has an {UnknownNameError('key', key, known)}")
        for key in needed:
            if key not in value:
                raise _WrongPartError(f"has no {key!r}")

    return _checked(check, make_dict_structure_fn(kind, converter, **_left_out(kind)))


def _left_out(kind: Any) -> dict[str, Any]:
    """What cattrs is told about the fields of a dataclass that JSON does not hold."""
    some = (field for field in fields(kind) if not field.metadata.get("json", True))
    return {field.name: override(omit=True) for field in some}


def _unstructure_hook(kind: Any, converter: Converter) -> Callable[[Any], Any]:
    return make_dict_unstructure_fn(kind, converter, **_left_out(kind))


def _checked(check: Callable[[Any], None], convert: Hook) -> Hook:
    def hook(value: Any, kind: Any) -> Any:
        check(value)
        return convert(value, kind)

    return hook


def _call(value: Any, kind: Any) -> Any:
    return kind(value)


def _check(value: Any, wanted: str, is_right: Callable[[Any], bool]) -> None:
    if not is_right(value):
        raise _WrongPartError(f"must be {wanted}, not {value!r}")


def _check_object(value: Any) -> None:
    _check(value, "an object", lambda one: isinstance(one, dict))


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
    if isinstance(error, _WrongPartError):
        return BadValueError(f"{where} {error}")
    if isinstance(error, BadValueError):
        return BadValueError(f"{where}: {error}")
    if isinstance(error, GroundwalkError):
        return error
    raise error
