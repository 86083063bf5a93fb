"""Whether what was kept out bears out what a model was made from."""

import numpy as np

from diagnosis.residuals.predictor import Predictor
from diagnosis.verdict.verdict import Fit
from groundwalk.arrays import FloatArray

SURPRISE = 2.0
"""Times the error on what was learned from."""


def channel_rms(predictor: Predictor, residual: FloatArray) -> FloatArray:
    """(c,) rms of a residual (N,), both in units of noise."""
    c = len(predictor.channels.names)
    count = np.maximum(np.bincount(predictor.channel, predictor.scored, c), 1)
    return np.asarray(np.sqrt(np.bincount(predictor.channel, residual**2, c) / count))


def refutes(
    nominal: FloatArray, corrected: FloatArray, least_gain: float
) -> tuple[str, ...]:
    """What to say if a model makes the test worse than the plant alone; else nothing.

    Args:
      nominal: (N,) residual of the plant alone on the test data, in units of noise.
      corrected: (N,) of the model.
      least_gain: log-likelihood that was asked of an effect.
    """
    if 0.5 * float(corrected @ corrected - nominal @ nominal) < least_gain:
        return ()
    return (
        "What was found makes motions that were kept out worse: it explains some of "
        "what is missing, but is not what is missing.",
    )


def surprises(learned: Predictor, left: FloatArray, fit: Fit) -> tuple[str, ...]:
    """What to say if the test is much worse than what was learned from; else nothing.

    Args:
      learned: of the data that the model was made from.
      left: (N,) what the model leaves of them.
      fit: errors on the test data.
    """
    before = max(float(np.sqrt(np.mean(channel_rms(learned, left) ** 2))), 1.0)
    if fit.corrected < SURPRISE * before:
        return ()
    errors = {name: one.corrected / one.floor for name, one in fit.channels.items()}
    name = max(errors, key=errors.__getitem__)
    return (
        f"What was kept out shows more than what was learned from: errors of "
        f"{fit.corrected:.2g} instead of {before:.2g} times the noise are left, most "
        f"of it in {name}. Something is missing that the other data hardly show.",
    )
