"""Finds stalls: moments after which all joints follow their commands later or earlier.

A bus that loses ticks, or a clock that is set, shifts the measured positions against
the commands, by the same time at all joints. A fit would mistake that for physics.
"""

from typing import NamedTuple

import numpy as np

from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

WINDOW_S, STEP_S, LONGEST_S = 1.0, 0.5, 0.3
"""Length [s] of the windows in which the lag of positions behind commands is measured,
time from one window to the next, and longest lag that is looked for."""

MOVES = 0.1
"""Share of its range in the recording that a joint must move within 1 s for its lag
behind the command to be measured there."""

SURE = 0.97
"""Correlation that position and delayed command must exceed for the delay to count."""

SHARP = 2.0
"""A delay counts if others, as far from it as a stall makes them, fit worse by this
factor in rms: a joint that moves evenly is like its command after any delay. A factor
of one or four tells the same (tested)."""

APART = 4
"""Number of 0.5 s steps between the two windows whose lags are compared: 2 s."""

LEAST_S, LEAST_TICKS, SPREAD_TICKS = 0.04, 3, 1.5
"""Smallest jump of the lag behind commands that counts as a stall, in seconds and in
ticks (both must be reached), and its largest spread over the joints in ticks."""

FEWEST_JOINTS = 3
"""Number of joints whose lag must jump alike in a stall; friction can change the lag of
single joints, too."""


class LagJump(NamedTuple):
    """A moment after which all joints of a recording follow their commands later."""

    time_s: float
    """Middle of the change in the recording's time."""
    later_s: float
    """Change of the lag behind the commands; negative for earlier."""


def lag_jumps(trace: Trace) -> list[LagJump]:
    """Find the moments, in order of time, at which the lag behind commands jumps.

    There are none without commands, or with fewer than three joints.
    """
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
        if not found or row - found[-1][0] > APART:
            found.append((row, middle))
        elif abs(middle) > abs(found[-1][1]):
            found[-1] = row, middle
    half = APART // 2
    return [
        LagJump(float(time_s[row + half]), middle * trace.tick_s)
        for row, middle in found
    ]


def said_of_stalls(trace: Trace) -> list[str]:
    """Sentences for the report, one for each jump of the lag behind commands."""
    return [
        f"{trace.name}: from {jump.time_s:.1f} s on all joints follow their commands "
        f"{abs(jump.later_s):.2f} s {'later' if jump.later_s > 0 else 'earlier'}: the "
        "recording stalled, and only its longest steady part is used"
        for jump in lag_jumps(trace)
    ]


def steady(trace: Trace) -> Trace:
    """The longest part of a recording in which the lag behind commands is steady."""
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
    """(W,) middles [s] of windows, and (W, j) lags [ticks] behind commands in them.

    A lag is NaN where a joint hardly moves or does not follow its command.
    """
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
    """Lag [ticks] behind a command that begins `most` rows earlier; NaN if unclear."""
    late = np.lib.stride_tricks.sliding_window_view(command, len(position))[::-1]
    late = late - late.mean(axis=1, keepdims=True)
    own = position - position.mean()
    size = np.linalg.norm(late, axis=1) * np.linalg.norm(own)
    alike = (late @ own) / np.maximum(size, 1e-12)
    best = int(np.argmax(alike))  # a missing value is never alike
    left = np.sqrt(np.maximum(1 - alike**2, 0.0))
    others = np.abs(np.arange(len(left)) - best) >= LEAST_TICKS
    sharp = np.all(left[others] > SHARP * left[best])
    return float(best) if alike[best] > SURE and best < most and sharp else np.nan
