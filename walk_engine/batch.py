"""Records of arrays over n robots, and how to change them for some robots only.

A record is a NamedTuple of arrays, or of records, whose last axis counts the robots.
"""

from typing import NamedTuple, TypeVar

import numpy as np

from groundwalk.arrays import BoolArray

Record = TypeVar("Record", bound=NamedTuple)


def select(chosen: BoolArray, new: Record, old: Record) -> Record:
    """The new record where a robot is chosen, the old one elsewhere."""
    fields = (
        select(chosen, one, other)
        if isinstance(one, tuple)
        else np.where(chosen, one, other)
        for one, other in zip(new, old, strict=True)
    )
    return new._make(fields)
