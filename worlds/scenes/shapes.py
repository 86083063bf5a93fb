"""Turns the shapes of robots and ground into arrays that a viewer can draw."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray, IntArray
from robots.description import Capsule, Foot
from terrain import Heightfield
from worlds.scenes.colours import DARK, GRASS, SHELL, Colour

SQUARE_M = 0.25
SOLE_THICKNESS_M = 0.012


class Capsules(NamedTuple):
    """Capsules as Rerun takes them: from `translations` [m] along the rotated z."""

    lengths: FloatArray
    radii: FloatArray
    translations: FloatArray
    quaternions: FloatArray
    """(n, 4) rotations x, y, z, w of the z axis to the capsules' axes."""
    colors: npt.NDArray[np.uint8]


class Mesh(NamedTuple):
    """Triangles between vertices, as Rerun takes them.

    Positions [m] and normals are (vertices, 3), colours red, green, blue (vertices, 3),
    and the indices of the triangles' vertices (triangles, 3). `albedo_factor` is the
    colour of a mesh of one colour.
    """

    vertex_positions: FloatArray
    triangle_indices: IntArray
    vertex_normals: FloatArray
    vertex_colors: npt.NDArray[np.uint8] | None = None
    albedo_factor: Colour | None = None


def shape_colours(shapes: Sequence[Capsule], accent: Colour) -> npt.NDArray[np.uint8]:
    """(n, 3) colours of a link's shapes; `accent` is the colour of the robot."""
    known = {"shell": SHELL, "dark": DARK, "accent": accent}
    return np.array([known[shape.colour] for shape in shapes], np.uint8)


def capsules(shapes: Sequence[Capsule], accent: Colour) -> Capsules:
    """A link's shapes as Rerun takes them; `accent` is the colour of the robot."""
    start = np.array([shape.start_m for shape in shapes])
    axis = np.array([shape.end_m for shape in shapes]) - start
    downward = axis[:, 2] < 0
    start[downward] += axis[downward]
    axis[downward] *= -1
    length = np.linalg.norm(axis, axis=1)
    is_sphere = length == 0
    axis[is_sphere] = (0, 0, 1)
    x, y, z = axis.T / np.where(is_sphere, 1, length)
    # The quaternion that turns +z into an upward axis a is (1 + z . a, z x a).
    turns = np.stack([-y, x, np.zeros_like(x), 1 + z], axis=1)
    return Capsules(
        lengths=length,
        radii=np.array([shape.radius_m for shape in shapes]),
        translations=start,
        quaternions=turns / np.linalg.norm(turns, axis=1, keepdims=True),
        colors=shape_colours(shapes, accent),
    )


def ground_mesh(ground: Heightfield) -> Mesh:
    """Triangles of a heightfield, coloured as a chessboard so that motion shows."""
    vertices_m = ground.vertices_m
    slope_y, slope_x = np.gradient(ground.heights_m, ground.spacing_m)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return Mesh(
        vertex_positions=vertices_m,
        triangle_indices=ground.triangles,
        vertex_normals=normals.reshape(-1, 3),
        vertex_colors=chessboard(vertices_m),
    )


def chessboard(place_m: FloatArray) -> npt.NDArray[np.uint8]:
    """(n, 3) colour of the ground at places (n, 3) [m], in squares of `SQUARE_M`."""
    square = np.floor(place_m[:, :2] / SQUARE_M).astype(np.intp).sum(axis=1) % 2
    return np.asarray(np.array(GRASS, np.uint8)[square])


def sole_mesh(foot: Foot, colour: Colour) -> Mesh:
    """Mesh of a sole as a plate with its true outline, in the foot's frame."""
    outline_m = _counterclockwise(foot.outline_m)
    corners = len(outline_m)
    low, high = (
        np.hstack([outline_m, np.full((corners, 1), foot.sole_height_m + above_m)])
        for above_m in (0.0, SOLE_THICKNESS_M)
    )
    outward = np.hstack([outline_m - outline_m.mean(axis=0), np.zeros((corners, 1))])
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    down, up = np.tile([0.0, 0.0, -1.0], (corners, 1)), np.tile([0, 0, 1], (corners, 1))
    # Four rings of vertices, for sharp edges: lower face, upper face, two of the side.
    index = np.arange(corners)
    after = np.roll(index, -1)
    first = np.zeros(corners, np.intp)
    below, around = 2 * corners, 3 * corners
    triangles = (
        (first, after, index),
        (first + corners, index + corners, after + corners),
        (index + below, after + below, after + around),
        (index + below, after + around, index + around),
    )
    return Mesh(
        vertex_positions=np.vstack([low, high, low, high]),
        triangle_indices=np.vstack([np.stack(part, axis=1) for part in triangles]),
        vertex_normals=np.vstack([down, up, outward, outward]),
        vertex_colors=np.tile(np.array(colour, np.uint8), (4 * corners, 1)),
    )


def sole_rim(foot: Foot) -> FloatArray:
    """(corners + 1, 3) closed outline of a sole in the foot's frame [m]."""
    rim_m = np.vstack([foot.outline_m, foot.outline_m[:1]])
    return np.hstack([rim_m, np.full((len(rim_m), 1), foot.sole_height_m)])


def _counterclockwise(outline_m: FloatArray) -> FloatArray:
    x, y = outline_m.T
    area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
    return outline_m if area > 0 else outline_m[::-1]


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
