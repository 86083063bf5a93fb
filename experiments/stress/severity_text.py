"""Families and severities as people read them: in words, millimetres and degrees."""

import math
from collections.abc import Mapping
from typing import Any

SHOWN = {"m": (1000.0, " mm"), "rad": (180.0 / math.pi, "°"), "1": (1.0, "")}
"""By unit: factor, and the unit that is printed."""


def family_text(family: str) -> str:
    """A family's name, such as "slope up"."""
    return family.replace("_", " ")


def severity_text(severity: float, unit: str | None) -> str:
    """A severity with its printed unit, such as "6.3 mm"; "-" where there is none."""
    if unit is None:
        return "-"
    factor, name = SHOWN[unit]
    return f"{severity * factor:.2g}{name}"


def half_text(curve: Mapping[str, Any]) -> str:
    """The half-fall severity with its interval, such as "6.3 mm (5 to 8.1)".

    "> 20 mm" means that less than half of the trials fall even there, "< 2 mm" that
    more than half do. Where an end of the interval is missing it is beyond what was
    tried.
    """
    half, unit = curve["half"], curve["unit"]
    if half is None:
        return "-"
    factor, _ = SHOWN[unit]
    text = severity_text(half["severity"], unit)
    if half["beyond"]:
        return f"{_beyond(half['beyond'], curve)} {text}"
    low, high = (
        "?" if half[end] is None else f"{half[end] * factor:.2g}"
        for end in ("low", "high")
    )
    return f"{text} ({low} to {high})"


def _beyond(side: str, curve: Mapping[str, Any]) -> str:
    """The sign as numbers have it: of friction, the harder is the smaller one."""
    severities = [rung["severity"] for rung in curve["rungs"]]
    falling = severities[-1] < severities[0]
    return {">": "<", "<": ">"}[side] if falling else side
