"""Declares and checks the bounded parameters of terrains."""

import dataclasses
from typing import Any, TypeVar

from groundwalk.errors import BadValueError
from groundwalk.json_kinds import is_number, is_whole

Parameter = float | int | tuple[float, float]
T = TypeVar("T", float, int, tuple[float, float])


def bounded(default: T, low: float, high: float) -> T:
    """Declare a dataclass field with a default and inclusive bounds.

    The default's type decides which values `checked` accepts for the field: a whole
    number (int), any number (float), or two increasing numbers (tuple).
    """
    return dataclasses.field(default=default, metadata={"bounds": (low, high)})


def checked(field: dataclasses.Field[Any], value: Any) -> Parameter:
    """Convert a value to the Python type of a dataclass field declared with `bounded`.

    Raises:
      BadValueError: the value has another type, or lies outside of the bounds.
    """
    low, high = field.metadata["bounds"]
    span = f"from {low:g} to {high:g}, not {value!r}"
    if isinstance(field.default, tuple):
        pair = tuple(value) if isinstance(value, tuple | list) else ()
        are_two = len(pair) == 2 and all(map(is_number, pair))
        if not (are_two and low <= pair[0] < pair[1] <= high):
            raise BadValueError(f"{field.name} must be two increasing numbers {span}")
        return float(pair[0]), float(pair[1])
    if isinstance(field.default, int):
        if not is_whole(value) or not low <= value <= high:
            raise BadValueError(f"{field.name} must be a whole number {span}")
        return int(value)
    if not is_number(value) or not low <= value <= high:
        raise BadValueError(f"{field.name} must be a number {span}")
    return float(value)
