"""What a trial is worth to the search."""

import numpy as np

from experiments.walking.trials import Trials
from groundwalk.arrays import FloatArray

FALL_PENALTY_CM_S = 15.0
"""Of the SGAT paper's experiment on the NAO."""


def reward_cm_s(
    trials: Trials, limit_s: float, fall_penalty_cm_s: float = FALL_PENALTY_CM_S
) -> FloatArray:
    """(n,) forward speed [cm/s] over the whole trial, less a penalty after a fall.

    A robot that fell stands still for the rest of its trial. Were its speed taken
    until the fall, the search would prefer a sprint that ends on the floor.

    Args:
      trials: how they went.
      limit_s: how long a trial lasts without a fall.
      fall_penalty_cm_s: what a fall costs.
    """
    progress = 100 * trials.distance_m / limit_s
    return np.asarray(progress - fall_penalty_cm_s * trials.fell)
