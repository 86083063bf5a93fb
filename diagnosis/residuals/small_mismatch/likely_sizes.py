"""Likely sizes of small errors by linear estimates."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import lsq_linear

from diagnosis.residuals.changes import Changes
from groundwalk.arrays import BoolArray, FloatArray


def likeliest(
    products: FloatArray,
    slopes: FloatArray,
    sizes: FloatArray,
    free: BoolArray,
    low: FloatArray,
    high: FloatArray,
    damping: float = 0.0,
) -> FloatArray:
    """(k,) sizes between `low` and `high` that are likeliest; 0 where not `free`.

    Args:
      products: (k, k) those of changes of a residual [noise] by one standard deviation
        of each, over its entries.
      slopes: (k,) products of these with the residual beside errors of the present
        (k,) `sizes`.
      sizes: in standard deviations.
      free: (k,) whether each may have a size.
      low: (k,) smallest ones.
      high: (k,) largest ones.
      damping: weight of squared steps from the present sizes, in units of the squares
        that each alone would change of the residual; 0 for none.
    """
    found = np.zeros(len(free))
    if free.any():
        power = products[np.ix_(free, free)]
        kept = damping * np.diag(power)
        wanted = slopes[free] - power @ sizes[free] - kept * sizes[free]
        ends = low[free] - 1e-9, high[free] + 1e-9
        root, least = _least_squares(power + np.diag(1 + kept), wanted)
        best = lsq_linear(root, least, ends).x
        found[free] = np.clip(best, low[free], high[free])
    return found


def _least_squares(
    power: FloatArray, slopes: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """(k, k) A and (k,) b with which |A x - b|^2 / 2 is x power x / 2 + slopes x.

    But for a constant. Products of 1e13 are rounded by more than 1, so that `power`
    (k, k) may seem to have a direction in which it falls: there it is level.
    """
    unit = 1 / np.sqrt(np.diag(power))
    squares, axes = np.linalg.eigh(power * unit * unit[:, None])
    roots = np.sqrt(np.maximum(squares, len(unit) * np.finfo(float).eps * squares[-1]))
    root = roots[:, None] * axes.T / unit
    return root, -(axes.T @ (unit * slopes)) / roots


def gain_of(
    changes: Changes,
    left: FloatArray,
    sizes: FloatArray,
    own: Sequence[int],
    fixed: BoolArray,
) -> float:
    """What is gained [nats] by other values of some errors, to first order.

    Args:
      changes: those of a residual [noise] by one standard deviation of each.
      left: (N,) residual [noise] beside the errors.
      sizes: (k,) present ones, in standard deviations.
      own: indices of those that may have any size.
      fixed: (k,) whether each of the others stays as it is.
    """
    free = np.union1d(np.flatnonzero(~fixed), own)
    prior = np.where(np.isin(free, own), 0.0, 1.0)
    slope = changes.on(left)[free] + prior * sizes[free]
    products = changes.products()[np.ix_(free, free)]
    power = np.linalg.pinv(products + np.diag(prior), hermitian=True)
    return 0.5 * float(slope @ power @ slope)
