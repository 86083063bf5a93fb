"""What models leave in recordings from which they were not learned."""

import numpy as np

from diagnosis.residuals.changes import Changes
from diagnosis.residuals.tolerance import Tolerance
from groundwalk.arrays import FloatArray, IntArray

BALANCED = 3.0
"""Largest pull of the data on a likely value, in its standard deviations: where it is
larger a bound holds the value, which does not change when a part is left out."""


def left_out(residual: FloatArray, changes: FloatArray, part: IntArray) -> FloatArray:
    """(N,) residual of a model, in each part as if that had not been fitted, whitened.

    To first order, that of the model fitted to all other parts (the residuals of
    cross-validation by blocks, Hastie, Tibshirani and Friedman 2009, "The elements of
    statistical learning", 7.10). What the others leave unknown of values makes them
    wrong in the part; residuals are whitened with that, so that they are as large as
    noise if nothing differs between the parts.

    Args:
      residual: (N,) residual [noise] of the model fitted to all.
      changes: (k, N) what one standard deviation of each value changes, before anything
        is measured.
      part: (N,) number of the part of each entry.
    """
    changes = changes[np.abs(changes @ residual) <= BALANCED]
    powers = changes @ changes.T + np.eye(len(changes))
    found = residual.copy()
    for number in np.unique(part):
        own = part == number
        some = changes[:, own]
        spread = np.linalg.inv(powers - some @ some.T)
        found[own] += spread @ (some @ residual[own]) @ some
        unknown = Tolerance(Changes.of(some), spread=(spread + spread.T) / 2)
        found[own] = unknown.without(found[own][None])[0]
    return found
