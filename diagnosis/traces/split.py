"""Shortens recordings, and divides them by use: for fitting, selection and test."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import window_s
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError

_LEAST_WHOLE, _LEAST_WHOLE_IF_LONG = 3, 6
"""Number of recordings from which on whole ones are set aside for selection and test:
usually the first, but the second if all last 8 s or more. Fewer recordings are each cut
into parts, since each may show a motion of its own."""
_LONG_S = 8.0
"""Duration [s] from which on recordings are long: only six or more of them are divided
without being cut."""
_SHARE = 0.25
"""Share of the recordings' time that is set aside for selection; as much again is set
aside for the test."""
_GAP_S = 0.2
"""Time between two parts of a recording [s] that is left unused."""
_TWICE_S = 20.0
"""Recordings of this length [s] are cut into eight parts instead of four."""
_STROKE_S = 0.2
"""Time [s] between the two positions by whose difference a joint's speed is judged."""
_MANY = 12
"""With this many recordings or fewer, all sets that may be set aside are compared; with
more recordings only every second set, every third one and so on."""
_LEAST_PART_ROWS = 8
"""Fewest rows that a part of a recording must have."""
FIT, SELECT, TEST = 0, 1, 2
"""Numbers for the three uses of a part: fitting, selection and the final test."""


@dataclass(frozen=True, eq=False)
class Split:
    """Traces, or parts of them, by their use; each row has at most one use.

    Attributes:
      fit: about half of the time; parameters are fitted to it.
      select: about a quarter of the time; decides between fitted models.
      test: about a quarter of the time, held out for the final errors.
    """

    fit: tuple[Trace, ...]
    select: tuple[Trace, ...]
    test: tuple[Trace, ...]


def split(traces: Sequence[Trace], errors: Sequence[FloatArray] | None = None) -> Split:
    """Divide traces into data for fitting, for selection and for the final test.

    If there are six traces, or three of which one is shorter than 8 s, whole ones are
    set aside for selection and test, such that all joints that move in them move in the
    rest, too. Otherwise, or if that is impossible, each trace is cut into parts, 0.2 s
    apart; their uses are ordered such that each use has as much motion as possible.
    If `errors` are given, the size of an error in each row (T,) of each trace, each one
    is cut, such that what is fitted shows as much error as the rest.
    There is no randomness: the same traces are always divided alike.

    Raises:
      BadRecordingError: a trace is too short to be cut.
    """
    long = all(trace.duration_s >= _LONG_S for trace in traces)
    least = _LEAST_WHOLE_IF_LONG if long else _LEAST_WHOLE
    if errors is None and len(traces) >= least:
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
    return _cut(traces, errors)


def _travel(trace: Trace) -> FloatArray:
    """(j,) range of each joint between its 1 % and 99 % quantiles [rad]."""
    position = trace.position_rad
    low, high = np.zeros(position.shape[1]), np.zeros(position.shape[1])
    for column, values in enumerate(position.T):
        there = values[np.isfinite(values)]
        if len(there):
            low[column], high[column] = np.quantile(there, (0.01, 0.99))
    return high - low


def _motion(trace: Trace) -> FloatArray:
    """(3 j,) each joint's range, then its speeds forward and backward, in radians.

    Speeds are distances in 0.2 s. Both ways count, since only a joint that moved both
    ways distinguishes friction from a constant force.
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
    """Choose traces to set aside; the rest must move each joint half as far as they do.

    Given (traces, j) ranges of joints, (traces,) durations, indices of the traces to
    choose from, and the wanted duration; [] if no choice fulfils this.
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
    """Sets of traces that may be set aside; of many, every second, third and so on."""
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
    """Smallest ratio, over the joints, of the motion in `rest` to that in `taken`."""
    most = np.maximum(taken.max(axis=0), rest.max(axis=0))
    moves = taken.max(axis=0) > 0.1 * most
    if not moves.any():
        return 1.0
    return float((rest.max(axis=0)[moves] / taken.max(axis=0)[moves]).min())


def _cut(traces: Sequence[Trace], errors: Sequence[FloatArray] | None) -> Split:
    """Cut each trace into parts, with uses in the order that covers motion best.

    Errors (T,) in each row of the traces count like a motion.

    The uses of each trace begin one part later in that order than those of the trace
    before, so that an event at the same time in all, such as a push, gets several uses.
    """
    best, chosen = -np.inf, list[tuple[Trace, int, FloatArray]]()
    for order in sorted(set(permutations((FIT, FIT, SELECT, TEST)))):
        parts = []
        for k, trace in enumerate(traces):
            first = k % len(order)
            own = None if errors is None else errors[k]
            parts += [
                (part, use, np.append(_motion(part), _largest(trace, part, own)))
                for part, use in _parts(trace, order[first:] + order[:first])
            ]
        motion = [
            np.stack([moved for _, use, moved in parts if use == wanted])
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
            tuple(part for part, use, _ in chosen if use == wanted)
            for wanted in (FIT, SELECT, TEST)
        )
    )


def _largest(trace: Trace, part: Trace, errors: FloatArray | None) -> float:
    """The largest of a trace's errors (T,) in a part of it; 0 if they are unknown."""
    if errors is None:
        return 0.0
    first, last = np.searchsorted(trace.time_s, part.time_s[[0, -1]])
    return float(errors[first : last + 1].max())


def _parts(trace: Trace, order: tuple[int, ...]) -> list[tuple[Trace, int]]:
    """Cut a trace into contiguous parts of equal length, each with its use."""
    # the uses go there and back, since equal parts of a periodic motion would
    # otherwise always have the same use
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


LEAST_S = 3.0
"""Time [s] that is kept at least of each recording, if it is that long."""

LEAST_FLOATING_S = 1.5
"""Time [s] that is kept at least of each recording with a floating base: short, since
such a robot is replayed in short windows without a warm-up."""


def shortened(
    traces: Sequence[Trace], longest_s: float, least_s: float = LEAST_S
) -> list[Trace]:
    """Cut each trace to the contiguous part in which the joints move most.

    All keep the same share of their time, such that together they last `longest_s` at
    most, but each at least `least_s`, if it is that long.
    """
    total_s = sum(trace.duration_s for trace in traces)
    if total_s <= longest_s:
        return list(traces)
    share = longest_s / total_s
    return [_liveliest(trace, share, least_s) for trace in traces]


def _liveliest(trace: Trace, share: float, least_s: float) -> Trace:
    length_s = max(share * trace.duration_s, least_s)
    rows = min(round(length_s / trace.tick_s), trace.ticks)
    moved = np.abs(np.diff(trace.position_rad, axis=0))
    q = trace.position_rad
    reach = np.nanmax(q, axis=0) - np.nanmin(q, axis=0)
    activity = np.nan_to_num(moved / np.maximum(reach, 1e-6)).sum(axis=1)
    total = np.concatenate([[0.0], np.cumsum(activity), [0.0]])[: trace.ticks]
    gain = total[rows - 1 :] - total[: trace.ticks - rows + 1]
    start = int(np.argmax(gain))
    return trace.part(start, start + rows)


MOST_COMPARED = 100_000
"""Most values of recordings that are compared with replays: memory grows with them."""


def thinned(plant: Plant, traces: Sequence[Trace], channels: int) -> list[Trace]:
    """Compare fewer rows of recordings that have very many values.

    Every second row, third, and so on: what is left to compare then is as if sensors
    were slower, while commands are replayed at full rate. Recordings that are replayed
    in short windows, which have few rows each, stay as they are.
    """
    whole = [
        trace.motion is None and window_s(plant, trace) is None for trace in traces
    ]
    values = sum(trace.ticks for trace in traces) * channels
    every = max(-(-values // MOST_COMPARED), 1)
    return [
        replace(trace, every=every) if own else trace
        for trace, own in zip(traces, whole, strict=True)
    ]
