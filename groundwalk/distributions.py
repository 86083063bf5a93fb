"""Tails and quantiles of the distributions that statistical tests use.

Those of `scipy.stats` by the same functions of `scipy.special`. Importing `scipy.stats`
takes half a second, a tenth of what checking a recording may take. Without freedom
(0 degrees) what they return is NaN.
"""

import numpy as np
from scipy import special

from groundwalk.arrays import FloatArray


def chi2_sf(value: float, freedom: float) -> float:
    """Probability that a chi-square variable exceeds a value."""
    return float(special.chdtrc(_some(freedom), value))


def chi2_isf(probability: float, freedom: FloatArray | float) -> FloatArray:
    """The values that chi-square variables exceed with a probability.

    One for each number of degrees of freedom.
    """
    return np.asarray(special.chdtri(_some(freedom), probability))


def chi2_ppf(probability: float, freedom: float) -> float:
    """The value below which a chi-square variable is with a probability."""
    return float(2 * special.gammaincinv(_some(freedom) / 2, probability))


def f_sf(value: float, above: float, below: float) -> float:
    """Probability that a ratio of variances exceeds a value.

    `above` and `below` are the degrees of freedom of the two variances.
    """
    return float(special.fdtrc(_some(above), _some(below), value))


def t_sf(value: float, freedom: float) -> float:
    """Probability that a variable of Student's t exceeds a value."""
    return float(special.stdtr(_some(freedom), -value))


def t_ppf(probability: float, freedom: float) -> float:
    """The value below which a variable of Student's t is with a probability."""
    return float(special.stdtrit(_some(freedom), probability))


def normal_ppf(probability: float) -> float:
    """The value below which a standard normal variable is with a probability."""
    return float(special.ndtri(probability))


def _some(freedom: FloatArray | float) -> FloatArray:
    """Degrees of freedom, NaN where there are none."""
    return np.where(np.asarray(freedom) > 0, freedom, np.nan)
