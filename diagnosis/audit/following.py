"""Compares each joint's position with each joint's command."""

from dataclasses import dataclass

import numpy as np

from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

_LONGEST_LAG_S = 0.25
"""Longest delay between command and position that is tried [s]."""
_LAGS = 8
"""Number of delays between command and position that are tried."""
_STILL_RAD = 2e-3
"""A joint whose range of motion or of commands is at most this [rad] is left out."""
_LEAST_ROWS = 50
"""Fewest rows from which commands and positions are compared."""


@dataclass(frozen=True, eq=False)
class Following:
    """Comparison of the commands and positions of the m joints that move.

    Constant offsets are removed first. In the (m, m) arrays the row is the command's
    joint and the column the position's.

    Attributes:
      misfit: (m, m) rms of position less command [rad], at the lag that fits best.
      correlation: (m, m) correlation, at the lag at which it is largest in size.
      slope: (m,) slope of each position over its own command.
      flipped: (m,) rms of position plus own command [rad]: small if a sign is wrong.
    """

    columns: tuple[int, ...]
    misfit: FloatArray
    correlation: FloatArray
    slope: FloatArray
    flipped: FloatArray


def following(trace: Trace) -> Following:
    """Compare the commands with the positions of all joints, at lags of up to 0.25 s.

    Rows with missing values are left out. Without commands or motion there are no
    joints to compare.
    """
    command, position = trace.command_rad, trace.position_rad
    nothing = Following((), *(np.zeros(shape) for shape in ((0, 0), (0, 0), 0, 0)))
    if command is None:
        return nothing
    moving = np.flatnonzero(
        (_spread(command) > _STILL_RAD) & (_spread(position) > _STILL_RAD)
    )
    command, position = command[:, moving], position[:, moving]
    if not len(moving):
        return nothing
    lags = np.unique(np.linspace(0, _LONGEST_LAG_S / trace.tick_s, _LAGS).astype(int))
    lags = lags[len(command) - lags >= _LEAST_ROWS]
    tables = [_compare(command[: len(command) - lag], position[lag:]) for lag in lags]
    if not tables:
        return nothing
    misfit, flipped, correlation, slope = (
        np.stack(parts) for parts in zip(*tables, strict=True)
    )
    own = np.abs(np.diagonal(correlation, axis1=1, axis2=2)).argmax(axis=0)
    best = np.abs(correlation).argmax(axis=0)
    return Following(
        tuple(int(column) for column in moving),
        misfit.min(axis=0),
        np.take_along_axis(correlation, best[None], axis=0)[0],
        np.take_along_axis(slope, own[None], axis=0)[0],
        flipped.min(axis=0),
    )


def _compare(
    command: FloatArray, position: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Misfit, flipped, correlation and slope of `Following` at one lag."""
    there = np.isfinite(command).all(axis=1) & np.isfinite(position).all(axis=1)
    count = max(int(there.sum()), 1)
    c = command[there] - command[there].mean(axis=0) if there.any() else command[:0]
    q = position[there] - position[there].mean(axis=0) if there.any() else position[:0]
    cross = c.T @ q / count
    command_power = (c**2).sum(axis=0) / count
    position_power = (q**2).sum(axis=0) / count
    both = command_power[:, None] + position_power
    own = np.diagonal(cross)
    size = np.sqrt(np.outer(command_power, position_power))
    return (
        np.sqrt(np.maximum(both - 2 * cross, 0.0)),
        np.sqrt(np.maximum(np.diagonal(both) + 2 * own, 0.0)),
        cross / np.maximum(size, np.finfo(float).tiny),
        own / np.maximum(command_power, np.finfo(float).tiny),
    )


def _spread(values: FloatArray) -> FloatArray:
    """(j,) range of each column; 0 where all values are missing."""
    there = np.isfinite(values)
    low = np.where(there, values, np.inf).min(axis=0)
    high = np.where(there, values, -np.inf).max(axis=0)
    return np.asarray(np.maximum(high - low, 0.0), float)
