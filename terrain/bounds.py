"""Declares and checks the bounded parameters of terrains."""

import dataclasses
import numbers
from typing import Any, TypeGuard, TypeVar

from groundwalk.errors import BadValueError

Parameter = float | int | tuple[float, float]
T = TypeVar("T", float, int, tuple[float, float])


def bounded(default: T, low: float, high: float) -> T:
    """Declare a dataclass field with a default and inclusive bounds.

    The default's type decides which values `checked` accepts for the field: a whole
    number (int), any number (float), or two increasing numbers (tuple).
    """
    return dataclasses.field(default=default, metadata={"bounds": (low, high)})


def checked(field: dataclasses.Field[Any], value: object) -> Parameter:
    """Convert a value to the Python type of a dataclass field declared with `bounded`.

    Raises:
      BadValueError: the value has another type, or lies outside of the bounds.
    """
    low, high = field.metadata["bounds"]
    span = f"from {low:g} to {high:g}, not {value!r}"
    if isinstance(field.default, tuple):
        pair = tuple(value) if isinstance(value, tuple | list) else ()
        if not _increase(low, pair, high):
            raise BadValueError(f"{field.name} must be two increasing numbers {span}")
        return float(pair[0]), float(pair[1])
    if isinstance(field.default, int):
        if not _is_whole(value) or not low <= value <= high:
            raise BadValueError(f"{field.name} must be a whole number {span}")
        return int(value)
    if not _is_real(value) or not low <= value <= high:
        raise BadValueError(f"{field.name} must be a number {span}")
    return float(value)


def _increase(low: float, pair: tuple[Any, ...], high: float) -> bool:
    """Whether a pair is exactly two numbers within bounds, the second one larger."""
    return (
        len(pair) == 2 and all(map(_is_real, pair)) and low <= pair[0] < pair[1] <= high
    )


def _is_real(value: object) -> TypeGuard[float]:
    """Whether a value is a number; a bool does not count as one."""
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _is_whole(value: object) -> TypeGuard[int]:
    """Whether a value is a whole number; a bool does not count as one."""
    return isinstance(value, numbers.Integral) and not isinstance(value, bool)
