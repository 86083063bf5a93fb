"""Changes records of arrays over n robots, for some of the robots only.

A record is a NamedTuple of arrays, or of records. The last axis of every array counts
the robots.
"""

from typing import NamedTuple, TypeVar

import numpy as np

from groundwalk.arrays import BoolArray

Record = TypeVar("Record", bound=NamedTuple)


def select(chosen: BoolArray, new: Record, old: Record) -> Record:
    """Merge two records: the new one for chosen robots, the old one for the others.

    Args:
      chosen: (n,) mask of the robots.
      new: record of arrays (..., n).
      old: record of the same kind.
    """
    fields = (
        select(chosen, one, other)
        if isinstance(one, tuple)
        else np.where(chosen, one, other)
        for one, other in zip(new, old, strict=True)
    )
    return new._make(fields)
