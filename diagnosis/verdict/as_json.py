"""Frozen dataclasses as JSON and back: nothing unknown, nothing missing, no wrong kind.

A field may be a number, text, true or false, a tuple, a mapping with texts as keys,
another dataclass, one of some words (`Literal`), or any of these or None.
"""

import difflib
import math
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from numbers import Real
from typing import Any, Literal, get_args, get_origin, get_type_hints

from groundwalk.errors import BadValueError


def to_plain(value: Any) -> Any:
    """Dataclasses and tuples as dictionaries and lists, field by field."""
    if is_dataclass(value):
        names = [field.name for field in fields(value)]
        return {name: to_plain(getattr(value, name)) for name in names}
    if isinstance(value, Mapping):
        return {key: to_plain(part) for key, part in value.items()}
    if isinstance(value, tuple | list):
        return [to_plain(part) for part in value]
    # NumPy's numbers among them.
    return float(value) if _is_number(value) else value


def from_plain(kind: Any, value: Any, where: str) -> Any:
    """What `to_plain` has made a plain value of.

    Args:
      kind: the type that the value shall have, such as a dataclass.
      value: as `json.loads` gives it.
      where: how a message names the value, such as "effects[0].probability".

    Raises:
      BadValueError: a key is missing or unknown, or a value is of the wrong kind.
    """
    if is_dataclass(kind):
        return _dataclass(kind, value, where)
    origin, arguments = get_origin(kind), get_args(kind)
    if type(None) in arguments:
        some = next(part for part in arguments if part is not type(None))
        return None if value is None else from_plain(some, value, where)
    if origin is Literal:
        return _checked(value, where, " or ".join(arguments), value in arguments)
    if origin is tuple:
        return _tuple(arguments, value, where)
    if origin is not None:  # a mapping
        _checked(value, where, "an object", isinstance(value, dict))
        part = arguments[1]
        places = {key: f"{where}.{key}" for key in value}
        return {key: from_plain(part, value[key], at) for key, at in places.items()}
    wanted, is_right = _SCALARS[kind]
    return kind(_checked(value, where, wanted, is_right(value)))


def check_number(name: str, value: float, low: float, high: float = math.inf) -> None:
    """Refuse what is no finite number between two bounds.

    Args:
      name: what the message calls it.
      value: the number.
      low: the least that is right.
      high: the most.

    Raises:
      BadValueError: it is not.
    """
    if not (_is_number(value) and low <= value <= high):
        span = f"from {low:g} to {high:g}" if high < math.inf else f"from {low:g} up"
        span = "" if low == -math.inf else f" {span}"
        raise BadValueError(f"{name} must be a finite number{span}, not {value!r}")


def _is_number(value: Any) -> bool:
    is_real = isinstance(value, Real) and not isinstance(value, bool)
    return is_real and math.isfinite(value)


_SCALARS: Mapping[Any, tuple[str, Callable[[Any], bool]]] = {
    float: ("a finite number", _is_number),
    str: ("text", lambda value: isinstance(value, str)),
    bool: ("true or false", lambda value: isinstance(value, bool)),
}


def _checked(value: Any, where: str, wanted: str, is_right: bool) -> Any:
    if not is_right:
        raise BadValueError(f"{where} must be {wanted}, not {value!r}")
    return value


def _dataclass(kind: Any, value: Any, where: str) -> Any:
    _checked(value, where, "an object", isinstance(value, dict))
    kinds = get_type_hints(kind)
    known = {field.name: kinds[field.name] for field in fields(kind)}
    for key in value:
        if key not in known:
            close = difflib.get_close_matches(key, list(known), n=1)
            hint = f"did you mean {close[0]!r}? " if close else ""
            raise BadValueError(
                f"{where} has an unknown key {key!r}: {hint}"
                f"known are {', '.join(known)}"
            )
    for key in known:
        if key not in value:
            raise BadValueError(f"{where} has no {key!r}")
    parts = {key: from_plain(known[key], value[key], f"{where}.{key}") for key in known}
    try:
        return kind(**parts)
    except BadValueError as error:
        raise BadValueError(f"{where}: {error}") from None


def _tuple(kinds: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    _checked(value, where, "a list", isinstance(value, list))
    if kinds[-1] is ...:
        kinds = (kinds[0],) * len(value)
    wanted = f"a list of {len(kinds)}"
    _checked(value, where, wanted, len(value) == len(kinds))
    return tuple(
        from_plain(kind, part, f"{where}[{index}]")
        for index, (kind, part) in enumerate(zip(kinds, value, strict=True))
    )
