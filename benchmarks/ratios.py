"""Times some work, and compares a ratio of times with a bound."""

import statistics
import time
from collections.abc import Callable, Sequence
from typing import Literal


def seconds(work: Callable[[], object]) -> float:
    """Measure the duration of a function call [s]."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def judged(
    name: str,
    ratios: Sequence[float],
    side: Literal["at least", "at most"],
    bound: float,
) -> tuple[str, bool]:
    """Compare the median of ratios with a bound.

    Args:
      name: name of the ratio in the report.
      ratios: the ratio in each round.
      side: whether the median must be "at least" or "at most" the bound.
      bound: the bound.

    Returns:
      A line for the report, and whether the median is on the right side.
    """
    median = statistics.median(ratios)
    passes = median >= bound if side == "at least" else median <= bound
    rounds = ", ".join(f"{ratio:.3f}" for ratio in ratios)
    verdict = "pass" if passes else "FAIL"
    return (
        f"  {name} : {median:.3f} (rounds {rounds}); {side} {bound} to pass: {verdict}"
    ), passes
