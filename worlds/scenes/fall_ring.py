"""Draws a ring on the ground around the place where a robot fell."""

import numpy as np

from groundwalk.arrays import FloatArray
from terrain import Heightfield

_RADIUS_M, _LIFT_M = 0.15, 0.002
_CORNERS = 48


def fall_ring(place_m: FloatArray, ground: Heightfield | None) -> FloatArray:
    """(corners, 3) closed ring [m] around a place (3,), 2 mm above the ground.

    Without ground the ring is level, at the height of the place.
    """
    turn = np.linspace(0, 2 * np.pi, _CORNERS + 1)
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    strip_m = place_m + _RADIUS_M * ring + np.array([0.0, 0.0, 2 * _LIFT_M])
    if ground is not None:
        strip_m[:, 2] = ground.height_at(strip_m[:, 0], strip_m[:, 1]) + _LIFT_M
    return np.asarray(strip_m)
