"""Confidence intervals of counted falls, and the severity at which half of them fall.

`half_fall` fits a logistic curve. Let x be the place on the ladder of severities, 0 its
mildest rung and 1 its hardest, on a logarithmic scale. The share of trials that fall is
modelled as 1 / (1 + exp(-(x - m) / w)), w > 0, because harder ground is never safer.
m is the result; w is a nuisance parameter. The estimate has the largest likelihood; the
interval holds all m whose profile log-likelihood is at most 3.84 / 2 below it (Wilks
1938). If all trials stand up to some rung and all fall from the next one on, the
likelihood grows without end as w shrinks: with the smallest width that is allowed, 90 %
of the change happens within a tenth of the ladder, and the estimate is the middle
between these two rungs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError

NORMAL_95 = 1.959963984540054
"""97.5 % quantile of the normal distribution: half the width of a 95 % interval in
standard deviations. A literal, because importing scipy.stats takes half a second."""

CHI_SQUARED_95 = 3.841458820694124
"""95 % quantile of the chi-squared distribution with one degree of freedom."""

WIDTHS = np.geomspace(0.017, 1.0, 16)
"""Candidate widths w of the logistic curve, in ladder lengths. The share of falls rises
from 5 to 95 % over 5.9 widths, so the smallest is a tenth of the ladder."""

MIDDLES = np.linspace(-1.0, 2.0, 601)
"""Candidate middles m: from one ladder length below to one above, in steps of 0.005."""

_FLAT = 1e-9
"""Log-likelihoods that differ by less are treated as equal: rounding error."""


def wilson(hits: int, trials: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a probability, from the count of hits.

    Unlike p +- 1.96 sqrt(p (1 - p) / n), it does not shrink to a point if all or none
    of the trials were hits.

    Args:
      hits: number of hits.
      trials: number of trials, at least one.

    Returns:
      Lower and upper end of the interval, both from 0 to 1.

    Example:
      >>> low, high = wilson(0, 10)
      >>> round(high, 2)
      0.28
    """
    from scipy.stats import binomtest

    interval = binomtest(hits, trials).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


@dataclass(frozen=True)
class HalfFall:
    """The severity at which half of the trials fall.

    Attributes:
      beyond: "" if the severity lies within the ladder, ">" if it is harder than every
        rung, "<" if it is milder.
      severity: the estimate; the hardest rung if `beyond` is ">", the mildest if "<".
      low, high: 95 % interval from mild to hard (for friction, where less is harder,
        `low` is the larger number); None if that end lies outside of the ladder.
    """

    beyond: str
    severity: float
    low: float | None
    high: float | None


def half_fall(
    severities: Sequence[float] | FloatArray,
    falls: Sequence[int],
    trials: Sequence[int],
) -> HalfFall:
    """Estimate the severity at which half of the trials fall.

    Args:
      severities: (rungs,) positive, from the mildest to the hardest, rising or falling.
      falls: (rungs,) trials that fell.
      trials: (rungs,) all trials.

    Raises:
      BadValueError: there are less than two rungs, or they are not ordered.

    Example:
      >>> half_fall([1, 2, 4, 8], falls=[0, 0, 8, 8], trials=[8] * 4).beyond
      ''
    """
    ladder = np.asarray(severities, float)
    if ladder.size < 2 or not (ladder > 0).all() or not _is_ordered(ladder):
        raise BadValueError(
            f"severities are {ladder.tolist()}; they must be at least two positive "
            "numbers from mild to hard"
        )
    x = np.log(ladder / ladder[0]) / np.log(ladder[-1] / ladder[0])
    profile = _profile(x, np.asarray(falls, float), np.asarray(trials, float))
    best = float(np.mean(MIDDLES[profile >= profile.max() - _FLAT]))
    within = MIDDLES[2 * (profile.max() - profile) <= CHI_SQUARED_95]

    def severity(place: float) -> float:
        return float(ladder[0] * (ladder[-1] / ladder[0]) ** place)

    mild, hard = float(within.min()), float(within.max())
    low = severity(min(mild, 1.0)) if mild >= 0 else None
    high = severity(max(hard, 0.0)) if hard <= 1 else None
    if best > 1:
        return HalfFall(">", float(ladder[-1]), low, None)
    if best < 0:
        return HalfFall("<", float(ladder[0]), None, high)
    return HalfFall("", severity(best), low, high)


def _is_ordered(ladder: FloatArray) -> bool:
    """Whether all numbers rise, or all fall."""
    steps = np.diff(ladder)
    return bool((steps > 0).all() or (steps < 0).all())


def _profile(x: FloatArray, falls: FloatArray, trials: FloatArray) -> FloatArray:
    """(middles,) log-likelihood of each middle, maximized over the widths."""
    away = (x - MIDDLES[:, None, None]) / WIDTHS[:, None]
    # log p = -log(1 + exp(-z)), log (1 - p) = -log(1 + exp(z))
    likelihood = -(
        falls * np.logaddexp(0.0, -away) + (trials - falls) * np.logaddexp(0.0, away)
    ).sum(axis=2)
    return np.asarray(likelihood.max(axis=1))
