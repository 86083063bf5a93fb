"""Intervals of shares that were counted."""

import math

NORMAL_95 = 1.959963984540054


def wilson(hits: int, trials: int, z: float = NORMAL_95) -> tuple[float, float]:
    """Wilson's interval of a probability of which `hits` of `trials` were seen.

    (p + z^2/2n +- z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n), Wilson 1927. Unlike
    p +- z sqrt(p(1-p)/n) it is no point where all or none of the trials were hits.

    Args:
      hits: how many.
      trials: of how many, at least one.
      z: quantile of the normal distribution; 95 % by default.
    """
    p = hits / trials
    centre = p + z * z / (2 * trials)
    half = z * math.sqrt(p * (1 - p) / trials + z * z / (4 * trials * trials))
    scale = 1 + z * z / trials
    return max(0.0, (centre - half) / scale), min(1.0, (centre + half) / scale)
