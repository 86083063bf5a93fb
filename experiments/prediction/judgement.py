"""Judges by an interval whether a corrected sim is better, and says so in a line."""

from collections.abc import Mapping
from typing import Literal

from diagnosis.conclude.error_ratio import LEVEL, Ratio

Judgement = Literal["holds", "undecided", "does not hold"]
"""Whether the corrected sim predicts recordings better that nobody has fitted."""

LITTLE = 1.1
"""Ratio of errors up to which two sims count as equally good."""

NOISE = 1.1
"""Multiple of the noise floor up to which an error is hardly more than noise."""


def judge(ratio: Ratio, nominal: float) -> Judgement:
    """Judge by the interval of how many times smaller the corrected sim's error is.

    It holds if the whole interval is above 1, and not all of it below 1.1. It does not
    if the whole interval is below 1, or below 1.1 while the sim's `nominal` error
    [noise floors] is more than noise, so that an improvement would have shown.

    Example:
      >>> judge(Ratio(7.0, 5.0, 9.0), 20.0)
      'holds'
    """
    if ratio.high < LITTLE:
        shows = ratio.high < 1 or nominal > NOISE
        return "does not hold" if shows else "undecided"
    return "holds" if ratio.low > 1 else "undecided"


def judgement_line(ratio: Ratio, nominal: float) -> str:
    """One line: the judgement, the ratio, and its interval.

    Example:
      >>> judgement_line(Ratio(7.0, 5.0, 9.0), 20.0)[:43]
      "holds: the corrected sim's error is 7.0 tim"
    """
    word, error = judge(ratio, nominal), "the corrected sim's error"
    if word == "undecided":
        few = "these recordings hardly show what the sim lacks"
        why = few if nominal <= NOISE else "more recordings would tell"
        return (
            f"{word}: whether {error} is smaller does not show, the ratio of the sim's "
            f"to it is {number(ratio.value)} {_interval(ratio.low, ratio.high)}; {why}"
        )
    if ratio.high < 1:
        ends = _interval(1 / ratio.high, 1 / ratio.low)
        return f"{word}: {error} is {number(1 / ratio.value)} times the sim's {ends}"
    ends = _interval(ratio.low, ratio.high)
    if word == "holds":
        many = f"{number(ratio.value)} times smaller"
        return f"{word}: {error} is {many} than the sim's {ends}"
    return (
        f"{word}: {error} is hardly smaller, the ratio of the sim's to it is "
        f"{number(ratio.value)} {ends}"
    )


def exceptions(judgement: Judgement, ratios: Mapping[str, float]) -> str:
    """Recordings that say otherwise than all together; "" if there are none.

    Args:
      judgement: that of all recordings together.
      ratios: by recording, how many times smaller the corrected sim's error is.
    """
    if judgement == "holds":
        other = {k: v for k, v in ratios.items() if v < 1 / LITTLE}
    else:
        other = {k: v for k, v in ratios.items() if v > LITTLE}
    if not other:
        return ""
    way = "larger" if judgement == "holds" else "smaller"
    each = ", ".join(f"{k} (ratio {number(v)})" for k, v in other.items())
    return f"In these recordings the corrected sim's error is {way}: {each}"


def _interval(low: float, high: float) -> str:
    return f"({100 * LEVEL:.0f} % interval {number(low)} to {number(high)})"


def number(value: float) -> str:
    """A ratio with two or three digits, such as "0.94", "7.1" and "28"."""
    return f"{value:.2f}" if value < 1.995 else f"{value:.{1 if value < 9.95 else 0}f}"
