"""Lanes of a viewer's time line: states that hold until the next one."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

SHORTEST_S = 0.05
"""A state that lasts less is shown for so long, or nobody would see it."""


class Lane(NamedTuple):
    """One lane: times [s] in increasing order, and the state that begins there.

    The state "" is none. The path is that of the lane in a viewer's file.
    """

    path: str
    changes: Sequence[tuple[float, str]]


def lane_of(path: str, spans: Iterable[tuple[float, float, str]]) -> Lane:
    """The lane with states from a start to an end [s], in any order.

    Where two overlap the later one is shown from its start on.

    Example:
      >>> lane_of("pulses", [(1.0, 2.0, "2 N m")]).changes
      [(1.0, '2 N m'), (2.0, '')]
    """
    changes = list[tuple[float, str]]()
    for start_s, end_s, state in sorted(spans):
        if changes and changes[-1][0] >= start_s:
            changes.pop()
        changes.append((start_s, state))
        changes.append((max(end_s, start_s + SHORTEST_S), ""))
    return Lane(path, changes)
