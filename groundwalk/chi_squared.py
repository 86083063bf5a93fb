"""The chi-squared distribution: of a sum of squares of independent normal values.

`scipy.stats.chi2` gives the same numbers, but its import takes 0.3 s of the 5 s that
`groundwalk check` may take. Source: Abramowitz and Stegun 1964, "Handbook of
mathematical functions", section 26.4.
"""

from scipy.special import chdtrc, chdtri, gammaincinv


def chance_above(value: float, freedom: float) -> float:
    """Chance that a sum of squares with some degrees of `freedom` is above a value.

    Example:
      >>> round(chance_above(3.841, 1), 3)
      0.05
    """
    return float(chdtrc(freedom, value))


def exceeded(chance: float, freedom: float) -> float:
    """The sum of squares that is exceeded with some chance.

    Example:
      >>> round(exceeded(0.05, 1), 3)
      3.841
    """
    return float(chdtri(freedom, chance))


def quantile(share: float, freedom: float) -> float:
    """The sum of squares below which a share of all are.

    Example:
      >>> round(quantile(0.5, 1), 3)
      0.455
    """
    return float(2 * gammaincinv(freedom / 2, share))
