"""A mean over neighbours."""

import numpy as np

from groundwalk.arrays import FloatArray


def moving_mean(values: FloatArray, width: int) -> FloatArray:
    """(T,) means over `width` neighbours; beyond the ends the end values hold."""
    before = width // 2
    padded = np.pad(values, (before, width - 1 - before), mode="edge")
    return np.convolve(padded, np.full(width, 1 / width), mode="valid")
