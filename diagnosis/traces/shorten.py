"""Cuts long recordings down to the parts in which the joints move most."""

from collections.abc import Sequence

import numpy as np

from diagnosis.traces.trace import Trace

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
