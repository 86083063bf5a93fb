"""The states of a walking robot, and the transitions between them.

    STANDING -> CROUCHING -> READY -> STARTING -> WALKING -> STOPPING -> READY
                             READY -> RISING -> STANDING

STANDING (upright) and READY (crouched) last until a request ends them, CROUCHING and
RISING a fixed time, STARTING and STOPPING one step, WALKING any number of steps.
Requests are read at rest and in the first tick of a step, crouching or rising.
"""

from enum import IntEnum

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import BoolArray, FloatArray
from walk_engine.time_profiles import parabolic_step

StateArray = npt.NDArray[np.int8]


class WalkState(IntEnum):
    """The state of a walking robot; arrays of states hold these numbers.

    STANDING is upright and READY crouched, both at rest; CROUCHING and RISING lead from
    one to the other; STARTING and STOPPING are the first and the last step.

    Example:
      >>> WalkState(4).name
      'WALKING'
    """

    STANDING = 0
    CROUCHING = 1
    READY = 2
    STARTING = 3
    WALKING = 4
    STOPPING = 5
    RISING = 6


_S = WalkState

# New state by old state (rows, in order) and by request: halt, walk, stand upright.
_ON_REQUEST: StateArray = np.array(
    [
        (_S.CROUCHING, _S.CROUCHING, _S.STANDING),
        (_S.CROUCHING, _S.CROUCHING, _S.CROUCHING),
        (_S.READY, _S.STARTING, _S.RISING),
        (_S.STARTING, _S.STARTING, _S.STARTING),
        (_S.STOPPING, _S.WALKING, _S.STOPPING),
        (_S.STOPPING, _S.STOPPING, _S.STOPPING),
        (_S.RISING, _S.RISING, _S.RISING),
    ],
    dtype=np.int8,
)
_WHEN_OVER: StateArray = np.array(
    [_S.STANDING, _S.READY, _S.READY, _S.WALKING, _S.WALKING, _S.READY, _S.STANDING],
    dtype=np.int8,
)
# Depth of the crouch (0 upright, 1 walking) when a state begins; its change in there.
_DEPTH = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0])
_DEEPENS = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0])
_RESTING = np.isin(np.arange(len(_S)), (_S.STANDING, _S.READY))
_STEPPING = np.isin(np.arange(len(_S)), (_S.STARTING, _S.WALKING, _S.STOPPING))


def is_resting(state: StateArray) -> BoolArray:
    """(n,) whether a robot is at rest, in the state STANDING or READY."""
    return _RESTING[state]


def is_stepping(state: StateArray) -> BoolArray:
    """(n,) whether one foot supports the robot while the other one swings."""
    return _STEPPING[state]


def on_request(state: StateArray, walk: BoolArray, stand: BoolArray) -> StateArray:
    """States (n,) after a request (n,) to walk or, which overrides it, to stand."""
    return _ON_REQUEST[state, np.where(stand, 2, walk)]


def when_over(state: StateArray) -> StateArray:
    """States (n,) that follow when a step, crouching or rising is over."""
    return _WHEN_OVER[state]


def crouched(state: StateArray, time_s: FloatArray, duration_s: float) -> FloatArray:
    """Depth (n,) of each robot's crouch: 0 standing upright, 1 at its walking height.

    `time_s` (n,) counts since crouching or rising began, which last `duration_s` [s].
    """
    return _DEPTH[state] + _DEEPENS[state] * parabolic_step(time_s, duration_s)
