"""The sun, and the shadows of round shapes."""

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from worlds.scenes.camera_rounds import Rounds, axis_part

SUN = np.array([-0.15, -0.5, 0.85]) / np.linalg.norm([-0.15, -0.5, 0.85])
"""Direction to the sun: at the robot's right."""

PENUMBRA_M = 0.006
"""Width of a shadow's edge."""


def in_sun(rounds: Rounds, place_m: FloatArray) -> FloatArray:
    """(n,) 0 in the shadow of a shape, 1 in the sun, for (n, 3) places.

    Along the direction of the sun every capsule is a flat stadium: what is within
    the stadium, and behind the capsule, is in its shadow.
    """
    known = np.isfinite(rounds.start_m + rounds.end_m).all(axis=1)
    shapes = np.flatnonzero(~rounds.glows & known)
    sun = np.ones(len(place_m))
    if not shapes.size:
        return sun
    across = np.cross(SUN, (0.0, 1.0, 0.0))
    across /= np.linalg.norm(across)
    frame = np.stack([across, np.cross(SUN, across), SUN])
    start, end = (ends[shapes] @ frame.T for ends in (rounds.start_m, rounds.end_m))
    radius = rounds.radius_m[shapes]
    reach = (radius + PENUMBRA_M)[:, np.newaxis]
    low = np.minimum(start, end)[:, :2] - reach
    high = np.maximum(start, end)[:, :2] + reach
    x, y = place_m @ frame[0], place_m @ frame[1]
    rows = np.flatnonzero(_within(x, y, low.min(axis=0), high.max(axis=0)))
    x, y, place = x[rows], y[rows], place_m[rows] @ frame.T
    for i in range(len(shapes)):
        near = np.flatnonzero(_within(x, y, low[i], high[i]))
        part = axis_part(place[near, :2], start[i, :2], end[i, :2])
        from_axis = place[near] - (start[i] + part * (end[i] - start[i]))
        beyond_m = np.hypot(from_axis[:, 0], from_axis[:, 1]) - radius[i]
        shadow = np.clip(0.5 - beyond_m / PENUMBRA_M, 0, 1)
        behind = from_axis[:, 2] < -0.3 * radius[i]
        here = rows[near]
        sun[here] = np.minimum(sun[here], 1 - shadow * behind)
    return sun


def _within(
    x: FloatArray, y: FloatArray, low: FloatArray, high: FloatArray
) -> BoolArray:
    """(n,) whether places are in a rectangle."""
    inside = (x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1])
    return np.asarray(inside)
