"""Recordings of a two-link arm that another library integrated."""

from dataclasses import replace

import numpy as np
from joint_rigs import arm_law, integrated, ticks, trace_of
from made_up_traces import GAINS, arm, arm_command

from diagnosis.residuals.predictor import Channels
from diagnosis.search.rules import Rules

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
LEAN = Rules(
    single_effects=6,
    further_effects=2,
    beam=1,
    growths_each=2,
    pairs=3,
    finished=3,
    swaps=2,
    largest=2,
)
"""Looks less far, in a fraction of the time."""
SINGLE = replace(LEAN, finished=2, pairs=0, swaps=1, largest=1)
"""Looks for a single effect only."""


def measured(seed, more_nm=None, duration_s=3.0, gain=(1.0, 1.0)):
    """A trace whose servos follow their law, plus torques `more_nm(t, q, v)` (2,).

    Args:
      seed: of command and noise.
      more_nm: what the plant does not know of.
      duration_s: of the trace.
      gain: of the servos' stiffness, as a factor.
    """
    time_s = ticks(duration_s, 0.02)
    command = arm_command(time_s, seed)
    kp, kd = GAINS["kp"] * np.array(gain), GAINS["kd"]

    def torque_nm(t, q, v, k):
        more = 0.0 if more_nm is None else more_nm(t, q, v)
        return kp * (command[k] - q) - kd * v + more

    truth = integrated(arm_law(torque_nm), time_s, np.zeros(4))[:, :2]
    random = np.random.default_rng(seed + 1000)
    noise = NOISE_RAD * random.standard_normal(truth.shape)
    return trace_of(arm(), time_s, truth + noise, command_rad=command)
