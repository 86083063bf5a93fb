"""Deals out which robot each doctored case has, and what is doctored."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from experiments.concealed.doctored.robots import NOTHING, OUTSIDE, REAL_SETS
from experiments.concealed.second.plan import dealt
from groundwalk.errors import BadRecordingError

UNDOCTORED = 1 / 3
"""Share of each robot's cases in which nothing is doctored, if something can be."""
_OUTSIDE_WEIGHT = 0.5
"""Share of what is outside the library, relative to each effect in it."""


def planned_real(data: Path, seed: int, count: int, number: int) -> tuple[str, str]:
    """Name of the robot (in `REAL_SETS`), and what is doctored, of case `number`.

    Raises:
      BadRecordingError: the folder of data holds no recordings of any of the robots.
    """
    there = _there(data)
    if not there:
        folders = ", ".join(one.folder for one in REAL_SETS.values())
        raise BadRecordingError(f"{data} has no recordings in any of {folders}")
    return _planned(there, seed, count)[number]


@cache  # looking into folders takes long on some disks
def _there(data: Path) -> tuple[str, ...]:
    return tuple(name for name, one in REAL_SETS.items() if one.there(data))


@cache
def _planned(there: Sequence[str], seed: int, count: int) -> list[tuple[str, str]]:
    shares = {}
    for name in there:
        real = REAL_SETS[name]
        undoctored = UNDOCTORED if real.doctorings else 1.0
        shares[name, NOTHING] = undoctored * real.share
        weights = {
            each: _OUTSIDE_WEIGHT if each in OUTSIDE else 1.0
            for each in real.doctorings
        }
        for each, weight in weights.items():
            part = weight / sum(weights.values())
            shares[name, each] = (1 - undoctored) * real.share * part
    return dealt(shares, count, np.random.default_rng([seed, count]))
