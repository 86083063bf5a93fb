"""Capsules in the world: where rays of light meet them, and their shadows."""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray

SUN = np.array([-0.15, -0.5, 0.85]) / np.linalg.norm([-0.15, -0.5, 0.85])
"""(3,) unit vector to the sun: above, to the right of a robot that walks along x."""

PENUMBRA_M = 0.006
"""Width of a shadow's soft edge [m]."""


class Rounds(NamedTuple):
    """The n capsules of a picture; one whose two ends coincide is a sphere.

    Axes go from start to end (n, 3) in the world frame; colours (n, 3) are red, green,
    blue from 0 to 255. Marks that glow, such as a force's arrow, have the same colour
    in any light, are never hidden by other shapes and cast no shadow.
    """

    start_m: FloatArray
    end_m: FloatArray
    radius_m: FloatArray
    colour: FloatArray
    glows: BoolArray


def axis_part(place: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """(n, 1) position, from 0 at start to 1 at end, of an axis' point nearest a place.

    Places are (n, 2) or (n, 3) [m]; each has an axis of its own, or all have one.
    """
    axis = end - start
    square = np.sum(axis * axis, axis=-1, keepdims=True)
    along = np.sum((place - start) * axis, axis=-1, keepdims=True)
    return np.asarray(np.clip(along / np.where(square > 0, square, 1), 0, 1))


def distances(
    eye: FloatArray, rays: FloatArray, start: FloatArray, end: FloatArray, radius: float
) -> FloatArray:
    """(...) distance [m] at which each ray meets a capsule; infinity if it does not.

    A ray meets the cylinder at the t where |(eye - start) + t ray|, without its part
    along the axis, equals the radius. The ends of the capsule are two spheres. All rays
    begin at `eye` (3,) and have unit directions (..., 3).
    """
    axis, to_eye = end - start, eye - start
    square = float(axis @ axis)
    depth = np.minimum(*(_sphere(eye - place, rays, radius) for place in (start, end)))
    if square == 0:
        return depth
    ray_axis, eye_axis = rays @ axis, float(to_eye @ axis)
    a = square - ray_axis**2
    b = square * (rays @ to_eye) - eye_axis * ray_axis
    c = square * float(to_eye @ to_eye) - eye_axis**2 - radius**2 * square
    inner = b * b - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        side = (-b - np.sqrt(inner)) / a
        along = eye_axis + side * ray_axis
        meets = (inner >= 0) & (along > 0) & (along < square)
    return np.where(meets, np.minimum(side, depth), depth)


def _sphere(to_eye: FloatArray, rays: FloatArray, radius: float) -> FloatArray:
    b = rays @ to_eye
    inner = b * b - (float(to_eye @ to_eye) - radius**2)
    return np.where(inner >= 0, -b - np.sqrt(np.maximum(inner, 0)), np.inf)


def in_sun(rounds: Rounds, place_m: FloatArray) -> FloatArray:
    """(n,) share of sunlight at places (n, 3): 0 in a capsule's shadow, 1 in the sun.

    Seen from the sun, a capsule is a flat stadium; places inside of it and behind the
    capsule are in its shadow.
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
    """(n,) whether points (x, y) lie in the rectangle with corners `low` and `high`."""
    inside = (x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1])
    return np.asarray(inside)
