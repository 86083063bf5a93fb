"""Converts frozen dataclasses to JSON and back, checking every key and value.

The fields of such a dataclass may be numbers, text, true or false, paths, tuples,
mappings with text as keys, words of a `Literal`, other dataclasses, or any of these or
None. An error message says in one line what is wrong and names the key. cattrs converts
the values, but silently coerces those of a wrong kind, such as the text "2" to a
number; the hooks here check each value first.

Example:
  >>> to_plain(TerrainSpec("stairs"))["seed"]
  0
  >>> from_plain(TerrainSpec, {"name": "stairs"}, "terrain", complete=False).seed
  0
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

Hook = Callable[[Any, Any], Any]
"""Type of a cattrs hook: takes a plain JSON value and a type, returns a value of it."""


class WrongPartError(BadValueError):
    """A part of a JSON value is wrong; the message lacks the name of its key.

    The message is, for example, "must be text, not 3"; `from_plain` puts the key first.
    """


def is_number(value: Any) -> bool:
    """Whether a value is a finite real number; True and False do not count as one."""
    try:
        is_real = isinstance(value, Real) and not isinstance(value, bool)
        return is_real and math.isfinite(value)
    except OverflowError:  # a whole number beyond all floats
        return False


def is_whole(value: Any) -> bool:
    """Whether a value is a whole number; True and False do not count as one."""
    return isinstance(value, Integral) and not isinstance(value, bool)


_SCALARS: Mapping[type, tuple[str, Callable[[Any], bool]]] = {
    float: ("a finite number", is_number),
    int: ("a whole number", is_whole),
    str: ("text", lambda value: isinstance(value, str)),
    bool: ("true or false", lambda value: isinstance(value, bool)),
    Path: ("text", lambda value: isinstance(value, str)),
}
"""For each type of a single value: its name in error messages, and the test whether a
plain JSON value may become one."""


@cache
def converter(complete: bool) -> Converter:
    """The converter that checks kinds and, if `complete`, refuses missing keys."""
    made = Converter(unstruct_collection_overrides={tuple: list})
    made.register_unstructure_hook(float, float)
    made.register_unstructure_hook(Path, str)
    made.register_unstructure_hook_factory(
        is_dataclass,
        lambda kind, made: make_dict_unstructure_fn(kind, made, **_left_out(kind)),
    )
    for scalar, (wanted, is_right) in _SCALARS.items():
        check = partial(_check, wanted=wanted, is_right=is_right)
        made.register_structure_hook(
            scalar, _checked(check, lambda value, kind: kind(value))
        )
    for matches, factory in (
        (_is_choice, lambda kind, _: lambda value, _: value),
        (_has_origin(Literal), _literal_hook),
        (_has_origin(tuple), _tuple_hook),
        (is_mapping, _mapping_hook),
        (is_dataclass, partial(_dataclass_hook, complete)),
    ):
        made.register_structure_hook_factory(matches, factory)
    return made


def _is_choice(kind: Any) -> bool:
    """Whether a type is `object` or a union: the dataclass that holds it checks it."""
    parts = set(get_args(kind)) - {type(None)}
    return kind is object or (get_origin(kind) in (Union, UnionType) and len(parts) > 1)


def _has_origin(origin: Any) -> Callable[[Any], bool]:
    return lambda kind: get_origin(kind) is origin


def _literal_hook(kind: Any, _: Converter) -> Hook:
    words = get_args(kind)
    return _checked(
        partial(_check, wanted=" or ".join(words), is_right=lambda one: one in words),
        lambda value, _: value,
    )


def _mapping_hook(kind: Any, converter: Converter) -> Hook:
    return _checked(_check_object, mapping_structure_factory(kind, converter))


def _tuple_hook(kind: Any, converter: Converter) -> Hook:
    *parts, last = get_args(kind)
    count = len(parts) + 1

    def check(value: Any) -> None:
        _check(value, "a list", lambda one: isinstance(one, list))
        if last is not ...:
            _check(value, f"a list of {count}", lambda one: len(one) == count)

    if last is ...:
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
                raise WrongPartError(f"has an {UnknownNameError('key', key, known)}")
        for key in needed:
            if key not in value:
                raise WrongPartError(f"has no {key!r}")

    return _checked(check, make_dict_structure_fn(kind, converter, **_left_out(kind)))


def _left_out(kind: Any) -> dict[str, Any]:
    """Arguments for cattrs that leave out a dataclass' fields marked `NOT_IN_JSON`."""
    some = (field for field in fields(kind) if not field.metadata.get("json", True))
    return {field.name: override(omit=True) for field in some}


def _checked(check: Callable[[Any], None], convert: Hook) -> Hook:
    def hook(value: Any, kind: Any) -> Any:
        check(value)
        return convert(value, kind)

    return hook


def _check(value: Any, wanted: str, is_right: Callable[[Any], bool]) -> None:
    if not is_right(value):
        raise WrongPartError(f"must be {wanted}, not {value!r}")


def _check_object(value: Any) -> None:
    _check(value, "an object", lambda one: isinstance(one, dict))


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
      value: as `json.loads` returns it.
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
    """Read JSON text, called `where` in errors; BadValueError for NaN and infinity."""
    try:
        return json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise BadValueError(f"{where} is not JSON: {error}") from None


def parse_object(text: str | bytes, where: str, version: int) -> dict[str, object]:
    """Read JSON text that holds one object; the result lacks its "format" key.

    BadValueError, in which the text is called `where`, if it is not JSON, contains NaN
    or an infinity, is no object, or its "format" is not this version.
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
    """Refuse (BadValueError) all but finite numbers between two inclusive bounds."""
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
