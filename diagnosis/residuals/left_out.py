"""What models leave in recordings from which they were not learned."""

import numpy as np

from groundwalk.arrays import FloatArray, IntArray


def left_out(residual: FloatArray, changes: FloatArray, part: IntArray) -> FloatArray:
    """(N,) residual of a model, in each part as if that had not been fitted.

    To first order, that of the model fitted to all other parts (the residuals of
    cross-validation by blocks, Hastie, Tibshirani and Friedman 2009, "The elements of
    statistical learning", 7.10). Values that the others do not determine change by
    about their standard deviation.

    Args:
      residual: (N,) residual [noise] of the model fitted to all.
      changes: (k, N) what one standard deviation of each value changes, before anything
        is measured.
      part: (N,) number of the part of each entry.
    """
    powers = changes @ changes.T + np.eye(len(changes))
    found = residual.copy()
    for number in np.unique(part):
        own = part == number
        some = changes[:, own]
        others = powers - some @ some.T
        found[own] += np.linalg.solve(others, some @ residual[own]) @ some
    return found
