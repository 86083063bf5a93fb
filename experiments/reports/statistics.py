"""Confidence intervals of fall rates, and the ground on which half of the trials fall.

`half_fall` fits a logistic curve. The severities tried (of a slope, a bump ...) are the
rungs of a ladder. Let x be the position on the ladder, 0 at its mildest rung and 1 at
its hardest, linear in the logarithm of the severity. The share of trials that fall is
modelled as 1 / (1 + exp(-(x - m) / w)), w > 0, because harder ground is never safer.
The middle m is the result; the width w is a nuisance parameter. The estimate maximizes
the likelihood; the interval holds all m whose profile log-likelihood is at most
3.84 / 2 below the maximum (Wilks 1938). If no trial falls up to some rung and all fall
from the next one on, the likelihood grows without bound as w shrinks; w is therefore
bounded so that 90 % of the change happens within a tenth of the ladder. The estimate is
then the middle between these two rungs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError

NORMAL_95 = 1.959963984540054
"""97.5 % quantile of the normal distribution: half the width of a 95 % interval."""

CHI_SQUARED_95 = 3.841458820694124
"""95 % quantile of the chi-squared distribution with one degree of freedom."""

WIDTHS = np.geomspace(0.017, 1.0, 16)
"""Candidate widths w of the logistic curve, in lengths of the ladder of severities. The
share of falls rises from 5 to 95 % over 5.9 w, at least a tenth of the ladder."""

MIDDLES = np.linspace(-1.0, 2.0, 601)
"""Candidate middles m of the logistic curve, in ladder lengths from the mildest rung:
from one length below the ladder to one above it, in steps of 0.005."""

_FLAT = 1e-9
"""Log-likelihoods that differ by less than this (rounding error) count as equal."""


def wilson(hits: int, trials: int) -> tuple[float, float]:
    """Lower and upper end of Wilson's 95 % interval of a probability, from counts.

    Unlike p +- 1.96 sqrt(p (1 - p) / n), it does not shrink to a point if all or none
    of the trials were hits.

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
      low, high: ends of the 95 % interval, the milder first (for friction, where less
        is harder, `low` is the larger number); None for an end outside of the ladder.
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

    The severities (rungs,) are at least two, positive, and rise (heights) or fall
    (friction); `falls` and `trials` (rungs,) are numbers of trials.

    Example:
      >>> half_fall([1, 2, 4, 8], falls=[0, 0, 8, 8], trials=[8] * 4).beyond
      ''
    """
    ladder = np.asarray(severities, float)
    steps = np.diff(ladder)
    is_ordered = (steps > 0).all() or (steps < 0).all()
    if ladder.size < 2 or not (ladder > 0).all() or not is_ordered:
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


def _profile(x: FloatArray, falls: FloatArray, trials: FloatArray) -> FloatArray:
    """(middles,) log-likelihood of each of `MIDDLES`, maximized over `WIDTHS`."""
    away = (x - MIDDLES[:, None, None]) / WIDTHS[:, None]
    # log p = -log(1 + exp(-z)), log (1 - p) = -log(1 + exp(z))
    likelihood = -(
        falls * np.logaddexp(0.0, -away) + (trials - falls) * np.logaddexp(0.0, away)
    ).sum(axis=2)
    return np.asarray(likelihood.max(axis=1))
