"""Finds the role of each joint of a leg (yaw, roll, pitch ...) from the axes alone."""

import itertools

import numpy as np

from groundwalk.arrays import FloatArray

ROLES = ("yaw", "roll", "pitch", "knee", "ankle_pitch", "ankle_roll")
KNEE, ANKLE = 3, 4
_X, _Y, _Z = range(3)
_CLEAR = 0.9


def roles(axes: FloatArray) -> tuple[int, ...]:
    """Places of `ROLES` in a leg's chain of joints.

    At the hip, yaw, roll and pitch are the joints whose axes come closest to z, x and
    y, all three together: on the NAO yaw leans by 45 degrees. The same holds for
    pitch and roll at the ankle.

    Args:
      axes: (6, 3) unit vectors from the hip to the foot, x forward, y left, z up.

    Raises:
      ValueError: the knee does not bend the leg about y.
    """
    if abs(axes[KNEE, _Y]) < _CLEAR:
        raise ValueError(f"the knee's axis is {np.round(axes[KNEE], 3)}, not y")
    hip = _closest(axes[:KNEE], (_Z, _X, _Y))
    ankle = _closest(axes[ANKLE:], (_Y, _X))
    return (*hip, KNEE, *(ANKLE + k for k in ankle))


def _closest(axes: FloatArray, wanted: tuple[int, ...]) -> tuple[int, ...]:
    """The order of axes in which they come closest to the wanted axes."""
    return max(
        itertools.permutations(range(len(axes))),
        key=lambda order: float(np.abs(axes[list(order), list(wanted)]).sum()),
    )
