"""Curves of the terrain stress test: falls and speeds over the severity of ground."""

import dataclasses
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
