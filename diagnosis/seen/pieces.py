"""Divides recordings into pieces, whose differences tell how sure curves are."""

from collections.abc import Sequence

import numpy as np

from diagnosis.traces.trace import Trace
from groundwalk.arrays import IntArray

ENOUGH = 3
"""Number of recordings from which on each is one piece."""

BLOCKS = 6
"""Number of pieces into which fewer recordings are divided, all together."""


def pieces_of(traces: Sequence[Trace]) -> tuple[list[IntArray], list[str]]:
    """The piece of each row (T,) of each trace, and different names of all pieces.

    Recordings are pieces if there are three or more. Fewer are divided into blocks of
    equal numbers of rows, as what differs from block to block in one recording, such as
    warmth, may differ less than from one recording to another.
    """
    parts = 1 if len(traces) >= ENOUGH else BLOCKS // max(len(traces), 1)
    found, names = list[IntArray](), list[str]()
    for number, trace in enumerate(traces):
        own = np.arange(trace.ticks) * parts // trace.ticks
        found.append(own + len(names))
        same = sum(one.name == trace.name for one in traces[:number])
        name = f"{trace.name} ({same + 1})" if same else trace.name
        part = [f"{name}, part {k + 1}" for k in range(parts)]
        names += [name] if parts == 1 else part
    return found, names
