"""A ratio that was measured round by round, held against a bound."""

import statistics
from collections.abc import Sequence
from typing import Literal


def judged(
    what: str,
    ratios: Sequence[float],
    side: Literal["at least", "at most"],
    bound: float,
) -> tuple[str, bool]:
    """A line with the median, and whether that is on the right side of the bound."""
    median = statistics.median(ratios)
    passes = median >= bound if side == "at least" else median <= bound
    rounds = ", ".join(f"{ratio:.3f}" for ratio in ratios)
    verdict = "pass" if passes else "FAIL"
    return (
        f"  {what} : {median:.3f} (rounds {rounds}); {side} {bound} to pass: {verdict}"
    ), passes
