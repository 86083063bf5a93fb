"""How late a joint follows its command, by cross-correlation of their rates."""

from collections.abc import Sequence

import numpy as np

from diagnosis.replay.asked import centred
from diagnosis.seen.bins import BAND
from diagnosis.seen.result import Delay
from diagnosis.traces.noise import noise_of
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray

LONGEST_S = 0.5
"""Longest delay [s] that is looked for."""

SHORTEST_S = 1.0
"""Shortest piece [s] in which one is looked for."""

FEWEST_ROWS = 20
"""Fewest rows of a piece in which a delay is looked for."""

EDGE = 2
"""Rows at the ends of a piece whose rates are left out: not both sides of them are
known, and of slow motion a single wrong rate shifts the delay."""

ALIKE = 0.6
"""Correlation of command rate and velocity from which on a motion follows a command."""

MOST = 0.5
"""Share of the pieces with motion in which a joint must follow: one may by chance."""

MOVED = 20.0
"""Standard deviations of a position's noise over which a joint must move in a piece."""


def delay_of(
    traces: Sequence[Trace],
    pieces: Sequence[IntArray],
    names: Sequence[str],
    joint: int,
) -> Delay | None:
    """The delay of one joint in all pieces in which it follows its command.

    `pieces` are the piece (T,) of each row of each trace, `names` those of all pieces.
    """
    found, moved = dict[str, float](), 0
    for trace, own in zip(traces, pieces, strict=True):
        if trace.command_rad is None:
            continue
        command, position = centred(trace)[:, joint], trace.position_rad[:, joint]
        noise = noise_of(trace.time_s, position).total
        for piece in np.unique(own):
            rows = own == piece
            part = trace.time_s[rows], command[rows], position[rows]
            if not _moves(*part, noise):
                continue
            moved += 1
            delay = _delay_s(*part)
            if delay is not None:
                found[names[int(piece)]] = delay
    if not found or len(found) < MOST * moved:
        return None
    low, middle, high = np.quantile(list(found.values()), BAND).tolist()
    return Delay(middle, low, high, found)


def _moves(
    time_s: FloatArray, command_rad: FloatArray, position_rad: FloatArray, noise: float
) -> bool:
    """Whether a piece is long enough, and both command and position move in it."""
    known = np.isfinite(position_rad) & np.isfinite(command_rad)
    if known.sum() < FEWEST_ROWS or time_s[-1] - time_s[0] < SHORTEST_S:
        return False
    far = np.ptp(position_rad[known]) > MOVED * noise
    return bool(far and np.ptp(command_rad[known]) > 0)


def _delay_s(
    time_s: FloatArray, command_rad: FloatArray, position_rad: FloatArray
) -> float | None:
    """The delay [s] in one piece; None if the joint does not follow its command."""
    known = np.isfinite(position_rad) & np.isfinite(command_rad)
    tick_s = float(np.median(np.diff(time_s)))
    even = np.arange(time_s[0], time_s[-1], tick_s)
    rates = [
        np.gradient(np.interp(even, time_s[known], one[known]))[EDGE:-EDGE]
        for one in (command_rad, position_rad)
    ]
    longest = min(round(LONGEST_S / tick_s), len(even) // 2)
    return _latest(rates[0], rates[1], longest, tick_s)


def _latest(
    ahead: FloatArray, behind: FloatArray, longest: int, tick_s: float
) -> float | None:
    """The delay [s] at which two signals (T,) correlate best, between rows by parabola.

    The correlation of all rows that overlap, for each delay of -1 to `longest` rows.
    """
    correlation = np.empty(longest + 2)
    for k in range(-1, longest + 1):
        first = ahead[max(-k, 0) : len(ahead) - max(k, 0)]
        later = behind[max(k, 0) : len(behind) + min(k, 0)]
        first, later = first - first.mean(), later - later.mean()
        size = np.linalg.norm(first) * np.linalg.norm(later)
        correlation[k + 1] = first @ later / size if size > 0 else 0.0
    best = int(np.argmax(correlation))
    if correlation[best] < ALIKE or best in (0, longest + 1):
        return None
    before, peak, after = correlation[best - 1 : best + 2]
    between = 0.5 * (before - after) / (before - 2 * peak + after)
    return float((best - 1 + between) * tick_s)
