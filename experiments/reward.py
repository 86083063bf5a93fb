"""What a trial is worth to the search."""

import numpy as np

from experiments.trials import Trials
from groundwalk.arrays import FloatArray

FALL_PENALTY_CM_S = 15.0
"""Of the SGAT paper's experiment on the NAO."""


def reward_cm_s(trials: Trials) -> FloatArray:
    """(n,) forward speed [cm/s], less 15 after a fall."""
    return np.asarray(trials.speed_cm_s - FALL_PENALTY_CM_S * trials.fell)
