"""Curves of the terrain stress test: falls and speeds over the severity of ground.

Names of ground families and severities are in words, millimetres and degrees.
"""

import dataclasses
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from experiments.reports.statistics import half_fall, wilson
from experiments.stress.families import FAMILIES, FLAT
from experiments.stress.walks import Trial

Cell = Mapping[str, Any]
"""A robot, world, family of ground and severity (the fields of `Place`), and the
`trials` of all gaits there, as dicts."""

Curve = Mapping[str, Any]
"""Results of one gait on one family of ground in one world, over the severity: a dict
whose list `rungs` has an entry for each severity."""


def curves_of(cells: Sequence[Cell]) -> list[dict[str, Any]]:
    """Make a curve for every robot, world, family of ground and gait.

    The cells of a family of ground must be in order from mild to hard.
    """
    keys = dict.fromkeys(
        (cell["robot"], cell["world"], cell["family"], trial["gait"])
        for cell in cells
        for trial in cell["trials"]
    )
    return [_curve(cells, *key) for key in keys]


def _curve(
    cells: Sequence[Cell], robot: str, world: str, family: str, gait: str
) -> dict[str, Any]:
    rungs = [
        _rung(cell["severity"], trials_of(cell, gait))
        for cell in cells
        if (cell["robot"], cell["world"], cell["family"]) == (robot, world, family)
    ]
    half = None
    if family != FLAT:
        keys = ("severity", "falls", "trials")
        columns = ([rung[key] for rung in rungs] for key in keys)
        half = dataclasses.asdict(half_fall(*columns))
    known = FAMILIES.get(family)
    return {
        "robot": robot,
        "world": world,
        "family": family,
        "gait": gait,
        "quantity": known.quantity if known else None,
        "unit": known.unit if known else None,
        "half": half,
        "rungs": rungs,
    }


def trials_of(cell: Cell, gait: str) -> list[Trial]:
    """The trials of one gait in a cell (a robot, world, family of ground, severity)."""
    return [Trial(**trial) for trial in cell["trials"] if trial["gait"] == gait]


def _rung(severity: float, trials: Sequence[Trial]) -> dict[str, Any]:
    """Summarize a gait's trials at one severity: speed, falls and their causes."""
    speeds = [100 * trial.distance_m / trial.time_s for trial in trials]
    fallen = [trial for trial in trials if trial.fell]
    distances = [trial.distance_m for trial in fallen]
    low, high = wilson(len(fallen), len(trials))
    return {
        "severity": severity,
        "trials": len(trials),
        "falls": len(fallen),
        "fall_rate_low": low,
        "fall_rate_high": high,
        "speed_cm_s": float(np.mean(speeds)),
        "speed_std": float(np.std(speeds, ddof=1)) if len(speeds) > 1 else 0.0,
        "distance_to_fall_m": float(np.median(distances)) if distances else None,
        "causes": dict(Counter(trial.cause for trial in fallen).most_common()),
    }


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
