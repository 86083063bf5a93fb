"""Units that foreign files use, and their factors to SI units and radians."""

import math
import re
from collections.abc import Mapping

from groundwalk.errors import UnknownNameError
from worlds.recordings.recording import TIME

TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ANGLES = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": math.pi / 180.0,
    "turn": 2.0 * math.pi,
    "m": 1.0,
    "mm": 1e-3,
}
"""Units of angles, and of the ways of sliding joints."""
RATES = {
    **{f"{unit}/s": factor for unit, factor in ANGLES.items()},
    "rpm": 2.0 * math.pi / 60.0,
}
TORQUES = {"Nm": 1.0, "mNm": 1e-3, "kgcm": 0.0980665, "N": 1.0}
"""Units of torques, and of the forces of sliding joints."""

_OTHER_WRITINGS = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s",
    "msec": "ms", "millis": "ms", "milliseconds": "ms",
    "usec": "us", "µs": "us", "micros": "us", "microseconds": "us",
    "nsec": "ns", "nanos": "ns", "nanosec": "ns", "nanoseconds": "ns",
    "radian": "rad", "radians": "rad", "rads": "rad/s",
    "degree": "deg", "degrees": "deg", "°": "deg",
    "rev": "turn", "turns": "turn", "revolutions": "turn",
    "radps": "rad/s", "rad_s": "rad/s", "deg_s": "deg/s", "degps": "deg/s",
    "dps": "deg/s", "nm": "Nm", "n m": "Nm", "n*m": "Nm", "n.m": "Nm",
    "mnm": "mNm", "mn m": "mNm", "n": "N", "newton": "N",
}  # fmt: skip


def units_of(column: str) -> Mapping[str, float]:
    """Factors to SI units and radians, by unit, for a column of format 1.

    Columns of vectors, such as gyroscope.x, can only be SI units already.
    """
    quantity = column.partition(".")[0]
    if column == TIME:
        return TIMES
    return {
        "position": ANGLES,
        "command": ANGLES,
        "velocity": RATES,
        "torque": TORQUES,
        "command_torque": TORQUES,
    }.get(quantity, {"SI": 1.0})


def known_unit(text: str, column: str) -> str | None:
    """The unit that a text, such as "degrees" or "N m", means; None if it is none."""
    units = units_of(column)
    spelled = text.strip()
    if spelled in units:
        return spelled
    plain = re.sub(r"\s+", " ", spelled.lower())
    if plain in _OTHER_WRITINGS:
        plain = _OTHER_WRITINGS[plain]
    if plain not in units and f"{plain}/s" in units:
        plain += "/s"  # velocities in "deg" are per second
    return plain if plain in units else None


def factor(text: str, column: str) -> float:
    """The factor from a unit to SI units and radians, for a column of format 1.

    Raises:
      UnknownNameError: the unit is unknown, or is none of this column.

    Example:
      >>> round(factor("deg", "position.elbow"), 6)
      0.017453
    """
    unit = known_unit(text, column)
    if unit is None:
        raise UnknownNameError(f"unit of {column}", text, units_of(column))
    return units_of(column)[unit]
