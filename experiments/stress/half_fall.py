"""The severity at which half of the trials fall, from trials along a ladder.

With x the place on the ladder, 0 its mildest and 1 its hardest rung, in the logarithm
of the severity, the share that falls is 1 / (1 + exp(-(x - m) / w)), w > 0: a harder
ground is never safer. m is wanted; w is nuisance. The estimate has the largest
likelihood, the interval all m whose profile likelihood is not worse by more than 3.84 /
2 (Wilks 1938). Where the data are separated, all standing up to a rung and all falling
from the next on, the likelihood has no largest w: the least that is allowed lets 90 %
of the change happen within a tenth of the ladder, and the estimate is the middle
between the rungs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError

CHI_SQUARED_95 = 3.841458820694124
WIDTHS = np.geomspace(0.017, 1.0, 16)
"""Of the logistic curve, in ladders; 5 to 95 % of the trials fall over 5.9 widths."""

MIDDLES = np.linspace(-1.0, 2.0, 601)
_FLAT = 1e-9
"""Likelihoods that differ by less are equal: the rounding's size."""


@dataclass(frozen=True)
class HalfFall:
    """Where half of the trials fall.

    Attributes:
      beyond: "" if within the ladder, ">" if harder than all that was tried, "<" if
        milder.
      severity: the estimate; at ">" the hardest tried, at "<" the mildest.
      low, high: 95 % interval from mild to hard, so that of friction `low` is the
        larger number; None where it reaches beyond what was tried.
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
    """Fit the curve to what was counted.

    Args:
      severities: (rungs,) from the mildest to the hardest, rising or falling; positive.
      falls: (rungs,) trials that fell.
      trials: (rungs,) trials.

    Raises:
      BadValueError: there are less than two rungs, or they are in no order.
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
    """(middles,) largest log-likelihood over all widths."""
    away = (x - MIDDLES[:, None, None]) / WIDTHS[:, None]
    # log p = -log(1 + exp(-z)), log (1 - p) = -log(1 + exp(z))
    likelihood = -(
        falls * np.logaddexp(0.0, -away) + (trials - falls) * np.logaddexp(0.0, away)
    ).sum(axis=2)
    return np.asarray(likelihood.max(axis=1))
