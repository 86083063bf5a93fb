"""Where something holds, row after row."""

import numpy as np

from groundwalk.arrays import BoolArray


def stretches(flags: BoolArray) -> list[tuple[int, int]]:
    """First and one past the last index of stretches of flags, gaps of one ignored."""
    closed = flags.copy()
    closed[1:-1] |= flags[:-2] & flags[2:]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], closed.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
