"""The depth of a robot's crouch, between standing upright and its walking height."""

import numpy as np

from groundwalk.arrays import FloatArray
from walk_engine.time_profiles import parabolic_step
from walk_engine.walk_state import StateArray, WalkState

_AT_START = np.ones(len(WalkState))
"""Depth of the crouch, 0 to 1, at the begin of each `WalkState`, by its number."""

_AT_START[[WalkState.STANDING, WalkState.CROUCHING]] = 0.0

_CHANGE = np.zeros(len(WalkState))
"""Change of the crouch's depth, 0 to 1, during each `WalkState`, by its number."""

_CHANGE[[WalkState.CROUCHING, WalkState.RISING]] = 1.0, -1.0


def crouched(state: StateArray, time_s: FloatArray, duration_s: float) -> FloatArray:
    """Depth (n,) of each robot's crouch: 0 standing upright, 1 at its walking height.

    Args:
      state: (n,) states of the robots, `WalkState`.
      time_s: (n,) time since the current crouching or rising began [s].
      duration_s: duration of crouching and of rising [s].
    """
    return _AT_START[state] + _CHANGE[state] * parabolic_step(time_s, duration_s)
