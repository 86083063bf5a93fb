"""Where a joint turns back, and how far it has travelled since."""

from itertools import pairwise

import numpy as np

from groundwalk.arrays import FloatArray


def turns(position_rad: FloatArray, least_rad: float) -> tuple[FloatArray, FloatArray]:
    """Direction (T,) of a joint, 1 or -1, and its travel since the last turn (T,).

    A turn is a row from which the joint moves back by more than `least_rad`, so that
    noise turns nothing. Before the first turn both are NaN, as nothing tells how far
    the joint has come.

    Example:
      >>> turns(np.array([0.0, 1.0, 2.0, 1.0, 0.0]), 0.5)[1]
      array([nan, nan,  0.,  1.,  2.])
    """
    at = _turning_rows(position_rad.tolist(), least_rad)
    way = np.full(len(position_rad), np.nan)
    travel = way.copy()
    for start, stop in pairwise([*at, len(way)]):
        own = slice(start, stop)
        gone = position_rad[own] - position_rad[start]
        way[own] = 1.0 if gone[-1] > 0 else -1.0
        travel[own] = np.abs(gone)
    return way, travel


def _turning_rows(position_rad: list[float], least_rad: float) -> list[int]:
    """The rows at which positions turn back by more than a distance."""
    found = list[int]()
    low = high = 0
    rising: bool | None = None
    for row, one in enumerate(position_rad):
        if one > position_rad[high]:
            high = row
        if one < position_rad[low]:
            low = row
        if rising is not False and position_rad[high] - one > least_rad:
            if rising:
                found.append(high)
            rising, low = False, row
        elif rising is not True and one - position_rad[low] > least_rad:
            if rising is False:
                found.append(low)
            rising, high = True, row
    return found
