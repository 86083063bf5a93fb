"""Merges two states of n robots: the new one for some robots, the old for the others.

A state is a record: a NamedTuple of arrays, or of further records. The last axis of
every array counts the robots.
"""

from typing import NamedTuple, TypeVar

import numpy as np

from groundwalk.arrays import BoolArray

Record = TypeVar("Record", bound=NamedTuple)


def select(chosen: BoolArray, new: Record, old: Record) -> Record:
    """Merge NamedTuples of arrays (..., n): `new` for robots chosen, else `old`."""
    fields = (
        select(chosen, one, other)
        if isinstance(one, tuple)
        else np.where(chosen, one, other)
        for one, other in zip(new, old, strict=True)
    )
    return new._make(fields)
