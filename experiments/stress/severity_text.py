"""Names of ground families and severities for pages: words, millimetres, degrees."""

import math
from collections.abc import Mapping
from typing import Any

SHOWN = {"m": (1000.0, " mm"), "rad": (180.0 / math.pi, "°"), "1": (1.0, "")}
"""By SI unit of a severity: the factor to the printed unit, and the printed unit."""


def family_text(family: str) -> str:
    """Name of a family of ground in words, such as "slope up"."""
    return family.replace("_", " ")


def severity_text(severity: float, unit: str | None) -> str:
    """A severity with its printed unit, such as "6.3 mm"; "-" if `unit` is None."""
    if unit is None:
        return "-"
    factor, name = SHOWN[unit]
    return f"{severity * factor:.2g}{name}"


def half_text(curve: Mapping[str, Any], interval: bool = True) -> str:
    """The severity at which half of the trials fall, with its 95 % interval.

    Examples: "6.3 mm (5 to 8.1)"; "not reached (up to 20 mm)" if fewer than half of the
    trials fall even at the hardest severity, 20 mm; "below 2 mm" or, for friction,
    "above 0.6" if more than half fall at the mildest. An end of the interval outside of
    the severities tried is "?".
    """
    half, unit = curve["half"], curve["unit"]
    if half is None:
        return "-"
    factor, _ = SHOWN[unit]
    text = severity_text(half["severity"], unit)
    falling = curve["rungs"][-1]["severity"] < curve["rungs"][0]["severity"]
    if half["beyond"] == ">":
        return f"not reached ({'down' if falling else 'up'} to {text})"
    if half["beyond"]:
        return f"{'above' if falling else 'below'} {text}"
    if not interval:
        return text
    low, high = (
        "?" if half[end] is None else f"{half[end] * factor:.2g}"
        for end in ("low", "high")
    )
    return f"{text} ({low} to {high})"
