"""Which rows are for fitting, which for selection, which for the final test."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np

from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError

_LEAST_WHOLE, _LEAST_WHOLE_IF_LONG = 3, 6
_LONG_S = 8.0
"""From this many recordings on, whole ones are set aside. Of a few, each of a motion of
its own, what one shows would be fitted, or judged, or tested, but never all of it: if
they are long enough, all are cut instead."""
_SHARE = 0.25
_GAP_S = 0.2
_TWICE_S = 20.0
"""Recordings of this length are cut into eight parts instead of four."""
_STROKE_S = 0.2
"""Time between positions that say how fast a joint goes."""
_MANY = 12
"""Up to this many recordings all choices are compared."""
_LEAST_PART_ROWS = 8
FIT, SELECT, TEST = 0, 1, 2


@dataclass(frozen=True, eq=False)
class Split:
    """Traces, or parts of them; no row is in two of them.

    Attributes:
      fit: about half of the time.
      select: about a quarter; says which of the fitted models is taken.
      test: about a quarter; opened once.
    """

    fit: tuple[Trace, ...]
    select: tuple[Trace, ...]
    test: tuple[Trace, ...]


def split(traces: Sequence[Trace]) -> Split:
    """Set traces aside; the same traces are always split alike.

    With six or more, or three short ones, whole traces are, such that what moves in
    those set aside moves in the others, too. Otherwise, or where that cannot be, each
    is cut into contiguous parts, 0.2 s apart, in the order that leaves the most motion
    to fit; no two traces next to each other are cut alike.

    Raises:
      BadRecordingError: a trace is too short to be cut.
    """
    long = all(trace.duration_s >= _LONG_S for trace in traces)
    if len(traces) >= (_LEAST_WHOLE_IF_LONG if long else _LEAST_WHOLE):
        travel = np.stack([_travel(trace) for trace in traces])
        seconds = np.array([trace.duration_s for trace in traces])
        left = list(range(len(traces)))
        test = _aside(travel, seconds, left, _SHARE * seconds.sum())
        left = [k for k in left if k not in test]
        select = _aside(travel, seconds, left, _SHARE * seconds.sum())
        if test and select:
            fit = [k for k in left if k not in select]
            return Split(
                *(tuple(traces[k] for k in part) for part in (fit, select, test))
            )
    return _cut(traces)


def _travel(trace: Trace) -> FloatArray:
    """(j,) range of each joint without its outermost percents."""
    position = trace.position_rad
    low, high = np.zeros(position.shape[1]), np.zeros(position.shape[1])
    for column, values in enumerate(position.T):
        there = values[np.isfinite(values)]
        if len(there):
            low[column], high[column] = np.quantile(there, (0.01, 0.99))
    return high - low


def _motion(trace: Trace) -> FloatArray:
    """(3 j,) how far each joint travels, and how fast it goes forward and backward.

    Friction is told from a constant force only where a joint went both ways.
    """
    apart = max(round(_STROKE_S / trace.tick_s), 1)
    position = trace.position_rad
    strokes = np.nan_to_num(position[apart:] - position[:-apart])
    if not len(strokes):
        strokes = np.zeros((1, position.shape[1]))
    ways = [np.quantile(way * strokes, 0.9, axis=0).clip(0.0) for way in (1, -1)]
    return np.concatenate([_travel(trace), *ways])


def _aside(
    travel: FloatArray, seconds: FloatArray, left: list[int], wanted_s: float
) -> list[int]:
    """Traces to set aside: nearly as long as wanted, what they do done by others, too.

    Args:
      travel: (traces, j).
      seconds: (traces,).
      left: traces to choose from; one of them stays at least.
      wanted_s: how much.
    """
    best, chosen = -np.inf, list[int]()
    for taken in _choices(left):
        rest = [k for k in left if k not in taken]
        covered = _covered(travel[list(taken)], travel[rest])
        if covered < 0.5:
            continue
        missed = abs(seconds[list(taken)].sum() - wanted_s) / wanted_s
        score = min(covered, 1.0) - missed
        if score > best + 1e-9:
            best, chosen = score, list(taken)
    return chosen


def _choices(left: list[int]) -> list[tuple[int, ...]]:
    """Sets of traces that may be taken; of many only stretches of their order."""
    most = len(left) - 1
    if len(left) <= _MANY:
        sizes = range(1, most // 2 + 1 if most > 1 else 2)
        return [taken for size in sizes for taken in combinations(left, size)]
    return [
        tuple(left[start::stride])
        for stride in range(2, len(left) + 1)
        for start in range(stride)
    ]


def _covered(taken: FloatArray, rest: FloatArray) -> float:
    """Least share of a joint's travel in the one that is in the other, too."""
    most = np.maximum(taken.max(axis=0), rest.max(axis=0))
    moves = taken.max(axis=0) > 0.1 * most
    if not moves.any():
        return 1.0
    return float((rest.max(axis=0)[moves] / taken.max(axis=0)[moves]).min())


def _cut(traces: Sequence[Trace]) -> Split:
    """Parts of each trace in the order that covers the test's motion best.

    Each trace begins one part later in that order: what happens in all of them at the
    same time, such as a push or what a drift has come to, is then fitted in some and
    judged in others.
    """
    best, chosen = -np.inf, list[tuple[Trace, int]]()
    for order in sorted(set(permutations((FIT, FIT, SELECT, TEST)))):
        parts = [
            part
            for k, trace in enumerate(traces)
            for part in _parts(trace, _rotated(order, k))
        ]
        motion = [
            np.stack([_motion(part) for part, use in parts if use == wanted])
            for wanted in (FIT, SELECT, TEST)
        ]
        covered = min(1.0, _covered(motion[TEST], motion[FIT]))
        covered += min(1.0, _covered(motion[SELECT], motion[FIT]))
        # and what is fitted should be judged, though that counts less
        covered += 0.5 * min(1.0, _covered(motion[FIT], motion[SELECT]))
        covered += 0.5 * min(1.0, _covered(motion[FIT], motion[TEST]))
        if covered > best + 1e-9:
            best, chosen = covered, parts
    return Split(
        *(
            tuple(part for part, use in chosen if use == wanted)
            for wanted in (FIT, SELECT, TEST)
        )
    )


def _rotated(order: tuple[int, ...], by: int) -> tuple[int, ...]:
    by %= len(order)
    return order[by:] + order[:by]


def _parts(trace: Trace, order: tuple[int, ...]) -> list[tuple[Trace, int]]:
    """Contiguous parts of equal length, with a gap after each, and their use."""
    # there and back, or a motion that repeats itself would always be used alike
    uses = order + order[::-1] if trace.duration_s >= _TWICE_S else order
    length_s = (trace.duration_s + _GAP_S) / len(uses)
    parts = []
    for k, use in enumerate(uses):
        start_s = trace.time_s[0] + k * length_s
        rows = np.searchsorted(trace.time_s, [start_s, start_s + length_s - _GAP_S])
        start, stop = int(rows[0]), int(rows[1])
        if k == len(uses) - 1:
            stop = trace.ticks
        if stop - start < _LEAST_PART_ROWS:
            raise BadRecordingError(
                f"{trace.name} is too short to be cut into {len(uses)} parts: "
                f"{trace.duration_s:.3g} s"
            )
        parts.append((trace.part(start, stop), use))
    return parts
