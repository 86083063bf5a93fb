"""Gyroscope feedback to the ankle angles, which balances a walking robot.

Turning rates are positive about the torso's axes (x forward, y left, z up); ankle
angles are positive about the same axes when the leg is straight. A torso that pitches
forward has a positive rate about y. A positive ankle pitch turns the foot about y
against the shin, toes down, so that the pressure moves forward under the foot and
pushes back. A torso that rolls to its right has a positive rate about x, and a positive
ankle roll turns the foot's right edge down. Both feedback terms are therefore added
with a positive sign, on both feet.
"""

import numpy as np

from groundwalk.arrays import FloatArray
from walk_engine.engine_config import EngineConfig
from walk_engine.step_plan import GaitColumns
from walk_engine.walk_state import StateArray, WalkState


def weight_of_new(gait: GaitColumns, tick_s: float, config: EngineConfig) -> FloatArray:
    """Weight (n,), 0 to 1, of a new gyroscope sample in the low-pass filter.

    The gait parameter `gyro_filter` is the weight for samples at 100 Hz; the result has
    the same time constant for samples every `tick_s` [s].
    """
    kept: FloatArray = 1.0 - gait["gyro_filter"]
    return 1.0 - kept ** (tick_s / config.gyro_filter_tick_s)


def low_pass(
    before_rad_s: FloatArray, rate_rad_s: FloatArray, weight: FloatArray
) -> FloatArray:
    """Filtered rates (k, n) [rad/s]: a low-pass of first order with weights (n,)."""
    return before_rad_s + weight * (rate_rad_s - before_rad_s)


def feedback_share(state: StateArray, support: StateArray) -> FloatArray:
    """Factor (2, n), 0 or 1, of the gyroscope feedback to each ankle: left, then right.

    During a step only the ankle of the support foot (1 left, -1 right, 0 both) gets
    feedback, in the state READY none, in all other states both.
    """
    both = np.where(state == WalkState.READY, 0.0, 1.0)
    return np.where(support == 0, both, np.stack((support > 0, support < 0)))
