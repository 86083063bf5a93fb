"""Finds stalls: moments after which all joints follow their commands later.

A bus that loses ticks, or a clock that is set, shifts the measured positions against
the commands, at all joints alike. A fit would mistake that for physics of the robot.
"""

from dataclasses import dataclass

import numpy as np

from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

WINDOW_S, STEP_S, LONGEST_S = 1.0, 0.5, 0.3
"""Length and distance of the windows in which lags are measured, and the longest lag
that is looked for [s]."""

MOVES = 0.1
"""Share of its range that a joint must move in a window for its lag to count."""

SURE = 0.97
"""Least correlation of position and delayed command for a lag to count."""

APART = 4
"""Distance in windows between the two lags that are compared."""

LEAST_S, LEAST_TICKS, SPREAD_TICKS = 0.04, 3, 1.5
"""Smallest jump of the lag in seconds and in ticks, and the largest spread of it over
the joints in ticks."""

FEWEST_JOINTS = 3
"""Joints that must jump alike; friction changes the lag of single joints, too."""


@dataclass(frozen=True)
class LagJump:
    """A moment after which a recording's joints follow their commands later.

    Attributes:
      time_s: middle of the change in the recording's time [s].
      later_s: change of the lag [s]; negative if the joints follow earlier.
    """

    time_s: float
    later_s: float


def lag_jumps(trace: Trace) -> list[LagJump]:
    """Find all jumps of the lag, in the order of time; none without commands."""
    if trace.command_rad is None or trace.position_rad.shape[1] < FEWEST_JOINTS:
        return []
    time_s, lag = _lags(trace)
    if len(lag) <= APART:
        return []
    change = lag[APART:] - lag[:-APART]
    least = max(LEAST_TICKS, LEAST_S / trace.tick_s)
    found: list[tuple[int, float]] = []
    for row, own in enumerate(change):
        seen = own[np.isfinite(own)]
        if len(seen) < FEWEST_JOINTS or np.ptp(seen) > SPREAD_TICKS:
            continue
        middle = float(np.median(seen))
        if abs(middle) < least:
            continue
        if found and row - found[-1][0] <= APART:
            if abs(middle) > abs(found[-1][1]):
                found[-1] = row, middle
            continue
        found.append((row, middle))
    half = APART // 2
    return [
        LagJump(float(time_s[row + half]), middle * trace.tick_s)
        for row, middle in found
    ]


def said_of_stalls(trace: Trace) -> list[str]:
    """Sentences for the report, one for each jump of a recording's lag."""
    return [
        f"{trace.name}: from {jump.time_s:.1f} s on all joints follow their commands "
        f"{abs(jump.later_s):.2f} s {'later' if jump.later_s > 0 else 'earlier'}: the "
        "recording stalled, and only its longest steady part is used"
        for jump in lag_jumps(trace)
    ]


def steady(trace: Trace) -> Trace:
    """The longest part of a recording without a jump of its lag."""
    jumps = lag_jumps(trace)
    if not jumps:
        return trace
    margin_s = APART * STEP_S
    starts = [trace.time_s[0], *(jump.time_s + margin_s for jump in jumps)]
    ends = [*(jump.time_s - margin_s for jump in jumps), np.inf]
    longest = int(np.argmax(np.minimum(ends, trace.time_s[-1]) - np.array(starts)))
    rows = np.searchsorted(trace.time_s, [starts[longest], ends[longest]])
    return trace.part(int(rows[0]), int(rows[1]))


def _lags(trace: Trace) -> tuple[FloatArray, FloatArray]:
    """(W,) middles of windows [s], and (W, j) lags [ticks]; NaN where there is none."""
    assert trace.command_rad is not None
    width = round(WINDOW_S / trace.tick_s)
    most, step = round(LONGEST_S / trace.tick_s), max(round(STEP_S / trace.tick_s), 1)
    position, command = trace.position_rad, trace.command_rad
    reach = np.nanmax(position, axis=0) - np.nanmin(position, axis=0)
    firsts = range(most, trace.ticks - width, step)
    lags = np.full((len(firsts), position.shape[1]), np.nan)
    for row, first in enumerate(firsts):
        for column in range(position.shape[1]):
            own = position[first : first + width, column]
            if np.ptp(own) > MOVES * reach[column] > 0:
                asked = command[first - most : first + width, column]
                lags[row, column] = _lag(own, asked, most)
    middles = [trace.time_s[first + width // 2] for first in firsts]
    return np.array(middles), lags


def _lag(position: FloatArray, command: FloatArray, most: int) -> float:
    """Ticks by which a position follows a command that begins `most` rows earlier."""
    late = np.lib.stride_tricks.sliding_window_view(command, len(position))[::-1]
    late = late - late.mean(axis=1, keepdims=True)
    own = position - position.mean()
    size = np.linalg.norm(late, axis=1) * np.linalg.norm(own)
    alike = (late @ own) / np.maximum(size, 1e-12)
    best = int(np.argmax(alike))  # a missing value is never alike
    return float(best) if alike[best] > SURE and best < most else np.nan
