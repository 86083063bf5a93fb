"""Draws a ring on the ground around the place where a robot fell."""

import numpy as np

from groundwalk.arrays import FloatArray
from terrain import Heightfield

RADIUS_M, LIFT_M = 0.15, 0.002
_CORNERS = 48


def fall_ring(place_m: FloatArray, ground: Heightfield | None) -> FloatArray:
    """(corners, 3) closed ring of points [m] around a place, 2 mm above the ground.

    Args:
      place_m: (3,) middle in the world; its height is used only without ground.
      ground: the ground that the ring follows; None for a level ring.
    """
    turn = np.linspace(0, 2 * np.pi, _CORNERS + 1)
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    strip_m = place_m + RADIUS_M * ring + np.array([0.0, 0.0, 2 * LIFT_M])
    if ground is not None:
        strip_m[:, 2] = ground.height_at(strip_m[:, 0], strip_m[:, 1]) + LIFT_M
    return np.asarray(strip_m)
