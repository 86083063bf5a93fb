"""Round shapes in the world, and where rays meet them."""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray


class Rounds(NamedTuple):
    """Capsules in the world; those whose ends are the same place are spheres."""

    start_m: FloatArray
    """(n, 3), as is the other end."""
    end_m: FloatArray
    radius_m: FloatArray
    """(n,)."""
    colour: FloatArray
    """(n, 3) from 0 to 255."""
    glows: BoolArray
    """(n,) marks: of one colour in any light, seen through all else, no shadow."""


def axis_part(place: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """(n, 1) where from 0 to 1 axes are nearest to places, of 2 or 3 coordinates."""
    axis = end - start
    square = np.sum(axis * axis, axis=-1, keepdims=True)
    along = np.sum((place - start) * axis, axis=-1, keepdims=True)
    return np.asarray(np.clip(along / np.where(square > 0, square, 1), 0, 1))


def distances(
    eye: FloatArray, rays: FloatArray, start: FloatArray, end: FloatArray, radius: float
) -> FloatArray:
    """How far along each ray a capsule is met; infinity where it is not.

    With the axis d and what lies across it marked by _|_, the side of the cylinder is
    where |(eye - start)_|_ + t ray_|_| = radius; the ends are two spheres.
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
