"""How far down a robot is, from standing upright to the height to walk in."""

import numpy as np

from groundwalk.arrays import FloatArray
from walk_engine.time_profiles import parabolic_step
from walk_engine.walk_state import StateArray, WalkState

_AT_START = np.ones(len(WalkState))
_AT_START[[WalkState.STANDING, WalkState.CROUCHING]] = 0.0

_CHANGE = np.zeros(len(WalkState))
_CHANGE[[WalkState.CROUCHING, WalkState.RISING]] = 1.0, -1.0


def crouched(state: StateArray, time_s: FloatArray, duration_s: float) -> FloatArray:
    """0 standing upright, 1 at the height to walk in, for each robot.

    Args:
      state: (n,) what the robots are doing.
      time_s: (n,) time since the current move began.
      duration_s: how long crouching and rising take.
    """
    return _AT_START[state] + _CHANGE[state] * parabolic_step(time_s, duration_s)
