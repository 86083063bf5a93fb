"""When a channel is off one way for a while: faint pushes that no energy tells."""

from itertools import chain

import numpy as np

from diagnosis.residuals.predictor import Predictor
from groundwalk.arrays import FloatArray

WINDOWS_S = (0.1, 0.25, 0.5)
"""How long a push may last: a servo that is pushed on stays off by so much."""

FAINT = 6.0
"""Standard deviations of a mean that no noise reaches in any window."""

_MEDIAN = 0.6744897501960817
"""Of the absolute value of what is normal, in standard deviations."""


def leanings(predictor: Predictor, residual: FloatArray) -> list[tuple[float, float]]:
    """Start and end [s] of the window of each length that leans most, the most first.

    What every window has, such as a weight that the sim does not know of, is none.

    Args:
      predictor: whose residual it is.
      residual: (N,) in units of noise.
    """
    c = len(predictor.channels.names)
    own = [
        (trace.time_s, residual[predictor.trace == number].reshape(-1, c))
        for number, trace in enumerate(predictor.traces)
    ]
    best = chain.from_iterable(
        sorted((_most(*one, window_s) for one in own), reverse=True)[:1]
        for window_s in WINDOWS_S
    )
    return [
        (start, end) for sure, start, end in sorted(best, reverse=True) if sure > FAINT
    ]


def _most(
    time_s: FloatArray, residual: FloatArray, window_s: float
) -> tuple[float, float, float]:
    """How sure the most leaning window is, where it starts and where it ends [s]."""
    rows = max(int(np.searchsorted(time_s, time_s[0] + window_s)), 1)
    if rows >= len(time_s):
        return 0.0, 0.0, 0.0
    total = np.vstack([np.zeros(residual.shape[1]), np.cumsum(residual, axis=0)])
    mean = np.abs(total[rows:] - total[:-rows]) / np.sqrt(rows)
    usual = np.maximum(np.median(mean, axis=0) / _MEDIAN, 1.0)
    sure = np.max(mean / usual, axis=1)
    first = int(np.argmax(sure))
    return float(sure[first]), float(time_s[first]), float(time_s[first + rows - 1])
