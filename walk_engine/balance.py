"""Gyroscope feedback to the ankles.

Turning rates are positive about the torso's axes (x forward, y left, z up), ankle
angles about the same axes when the leg is straight, so both signs follow from one
thought. A torso that pitches forward has a positive rate about y. A positive ankle
pitch turns the foot about y against the shin, toes down, so the pressure moves
forward under the foot and pushes back. Likewise a torso that rolls to its right has a
positive rate about x, and a positive ankle roll turns the foot's right edge down.
Both gains are therefore added with a plus, on both feet.
"""

import numpy as np

from groundwalk.arrays import FloatArray
from walk_engine.engine_config import EngineConfig
from walk_engine.step_plan import GaitColumns
from walk_engine.walk_state import StateArray, WalkState


def weight_of_new(gait: GaitColumns, tick_s: float, config: EngineConfig) -> FloatArray:
    """Weight of a new sample for which the filter's time constant does not change."""
    kept: FloatArray = 1.0 - gait["gyro_filter"]
    return 1.0 - kept ** (tick_s / config.gyro_filter_tick_s)


def low_pass(
    before_rad_s: FloatArray, rate_rad_s: FloatArray, weight: FloatArray
) -> FloatArray:
    """First-order filter of (k, n) rates."""
    return before_rad_s + weight * (rate_rad_s - before_rad_s)


def feedback_share(state: StateArray, support: StateArray) -> FloatArray:
    """Which ankles (2, n) take the feedback.

    The support foot while stepping, none while READY, else both.
    """
    both = np.where(state == WalkState.READY, 0.0, 1.0)
    return np.where(support == 0, both, np.stack((support > 0, support < 0)))
