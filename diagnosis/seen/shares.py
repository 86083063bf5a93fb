"""How much of a loss torque's variance goes with what, in data that were not used."""

from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from diagnosis.seen.drivers import BY_LOAD, drivers_of
from diagnosis.seen.result import Share
from diagnosis.seen.rows import Rows
from groundwalk.arrays import FloatArray, IntArray

RIDGE = 1e-3
"""Weight of the penalty on a regression's coefficients, as a share of the columns' own
variance: a piece may lack the poses of another."""

FEWEST_ROWS = 60
"""Fewest rows of a joint from which shares are computed."""

FEWEST_PIECES = 3
"""Fewest pieces of the recordings in which it moves: each in turn is not used."""

CLOSE = 0.3
"""Largest distance of two rows that move alike, in standard deviations of the motion
over all of its quantities."""

FEWEST_PAIRS = 30
"""Fewest pairs of rows that move alike from which repeatability is told."""

MOST_ROWS = 4000
"""Most rows of a joint: successive ones hardly differ."""


def shares_of(
    rows: Rows, piece: IntArray, joint: int, passive: bool = False
) -> tuple[tuple[Share, ...], float | None, float | None]:
    """The shares of all quantities, of all together, and of noise, of one joint.

    None, and no shares, from too few rows or pieces. `piece` (T,) is that of each row.
    Of a passive joint, whose loss torque is its load with the other sign, neither load
    nor acceleration explains anything.
    """
    loss = rows.loss_nm[:, joint]
    apart = np.arange(len(loss)) % rows.step == 0
    known = rows.counts[:, joint] & np.isfinite(loss)
    chosen = _few(np.flatnonzero(known & apart))
    own = piece[chosen]
    if len(chosen) < FEWEST_ROWS or len(np.unique(own)) < FEWEST_PIECES:
        return (), None, None
    drivers = drivers_of(rows, chosen, joint)
    for name in BY_LOAD if passive else ():
        del drivers[name]
    sums = _Sums(np.column_stack(list(drivers.values())), loss[chosen], own)
    ends = np.cumsum([0, *(one.shape[1] for one in drivers.values())])
    groups = {name: list(range(ends[k], ends[k + 1])) for k, name in enumerate(drivers)}
    every = range(int(ends[-1]))
    together = sums.share(every)
    found = []
    for name, columns in groups.items():
        without = sums.share([k for k in every if k not in columns])
        lost = max(max(together, 0.0) - max(without, 0.0), 0.0)
        found.append(Share(name, max(sums.share(columns), 0.0), lost))
    noise = _noise_share(rows, _few(np.flatnonzero(known)), joint, piece, passive)
    return tuple(found), max(together, 0.0), noise


def _few(chosen: IntArray) -> IntArray:
    """Every row, or with too many of them every second, third, and so on."""
    return chosen[:: max(-(-len(chosen) // MOST_ROWS), 1)]


class _Sums:
    """Sums of products of columns and values, of each piece and of all others.

    They are all that a linear regression needs, so that many are quick.
    """

    def __init__(
        self, columns: FloatArray, values: FloatArray, piece: IntArray
    ) -> None:
        """Sum up n rows: columns (n, k), values (n,) and the piece of each (n,)."""
        size = np.std(columns, axis=0)
        columns = (columns - columns.mean(axis=0)) / np.where(size > 0, size, 1.0)
        whole = np.column_stack([np.ones(len(values)), columns, values])
        parts = [whole[piece == one] for one in np.unique(piece)]
        self._own = [one.T @ one for one in parts]
        total = np.sum(self._own, axis=0)
        self._others = [total - one for one in self._own]

    def share(self, columns: Sequence[int]) -> float:
        """Share of the variance explained in pieces not used; below 0 if it harms."""
        left = sum(self._left(columns, k) for k in range(len(self._own)))
        before = sum(self._left((), k) for k in range(len(self._own)))
        return float(1 - left / before) if before > 0 else 0.0

    def _left(self, columns: Sequence[int], piece: int) -> float:
        """Sum of squared errors in a piece, of a regression on all others."""
        used = [0, *(1 + k for k in columns)]
        learned, own = self._others[piece], self._own[piece]
        penalty = RIDGE * learned[0, 0] * np.eye(len(used))
        penalty[0, 0] = 0.0
        size = np.linalg.solve(learned[np.ix_(used, used)] + penalty, learned[used, -1])
        squares = size @ own[np.ix_(used, used)] @ size
        return float(own[-1, -1] - 2 * size @ own[used, -1] + squares)


def _noise_share(
    rows: Rows, chosen: IntArray, joint: int, piece: IntArray, passive: bool
) -> float | None:
    """Share of the variance by which rows differ that move alike in other pieces.

    Half the mean squared difference of such pairs is the variance of what no function
    of the joint's motion explains, and a little more, as no two rows move quite alike.
    """
    quantities = [rows.position_rad, rows.velocity_rad_s]
    quantities += [] if passive else [rows.needed_nm]
    state = np.stack([one[chosen, joint] for one in quantities], axis=1)
    state /= np.maximum(np.std(state, axis=0), 1e-12)
    # opposite directions never move alike
    state = np.column_stack([state, 10 * np.sign(state[:, 1])])
    loss, piece = rows.loss_nm[chosen, joint], piece[chosen]
    squares = list[float]()
    for one in np.unique(piece):
        own, other = np.flatnonzero(piece == one), np.flatnonzero(piece != one)
        distance, nearest = cKDTree(state[other]).query(state[own])
        close = distance < CLOSE
        wrong = loss[own[close]] - loss[other[nearest[close]]]
        squares += (wrong**2).tolist()
    variance = float(np.var(loss))
    if len(squares) < FEWEST_PAIRS or variance <= 0:
        return None
    return min(0.5 * float(np.mean(squares)) / variance, 1.0)
