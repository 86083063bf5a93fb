"""Finds the role of each joint of a leg (yaw, roll, pitch ...) from the axes alone."""

import itertools

import numpy as np

from groundwalk.arrays import FloatArray

ROLES = ("yaw", "roll", "pitch", "knee", "ankle_pitch", "ankle_roll")
KNEE, ANKLE = 3, 4
_X, _Y, _Z = range(3)
_CLEAR = 0.9


def roles(axes: FloatArray) -> tuple[int, ...]:
    """Indices of yaw, roll, pitch, knee, ankle pitch and ankle roll among a leg's axes.

    The unit vectors (6, 3) go from hip to foot; x is forward, y left, z up. The order
    of the three hip joints is the one in which yaw, roll and pitch axes are closest to
    z, x and y in sum; the NAO's yaw axis leans by 45 degrees. The order of ankle pitch
    and roll is found in the same way. The fourth joint is the knee.

    Raises:
      ValueError: the knee's axis is not close to y.
    """
    if abs(axes[KNEE, _Y]) < _CLEAR:
        raise ValueError(f"the knee's axis is {np.round(axes[KNEE], 3)}, not y")
    hip = _closest(axes[:KNEE], (_Z, _X, _Y))
    ankle = _closest(axes[ANKLE:], (_Y, _X))
    return (*hip, KNEE, *(ANKLE + k for k in ankle))


def _closest(axes: FloatArray, wanted: tuple[int, ...]) -> tuple[int, ...]:
    """Order of axes (k, 3) in which they are closest, in sum, to k coordinate axes."""
    return max(
        itertools.permutations(range(len(axes))),
        key=lambda order: float(np.abs(axes[list(order), list(wanted)]).sum()),
    )
