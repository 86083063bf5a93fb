"""The mesh files of a link as triangles that a viewer can draw."""

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError
from robots.description import Link, VisualMesh
from robots.mesh_vertices import Surface, joined, mesh_surface
from worlds.scenes.colours import Colour

CELL_M = 0.003
"""What is smaller is not drawn: the files have details of screws, and megabytes."""


class LinkMesh(NamedTuple):
    """Triangles in the frame of a link's joint."""

    vertex_positions: FloatArray
    triangle_indices: IntArray
    vertex_normals: FloatArray
    albedo_factor: Colour


def link_mesh(link: Link, colour: Colour) -> LinkMesh | None:
    """All meshes of a link as one, coarser than the files; see `coarse`.

    None if there are none with triangles in them: capsules then have to do.
    """
    found = [_surface(mesh) for mesh in link.meshes]
    whole = coarse(joined([surface for surface in found if surface is not None]))
    if len(whole.triangles) == 0:
        return None
    points_m, triangles, normals = _shaded(whole)
    return LinkMesh(points_m, triangles, normals, colour)


def coarse(surface: Surface, cell_m: float = CELL_M) -> Surface:
    """A surface with one point, an old one, for all points in the same cubic cell.

    Triangles that have become lines or points go, and of several between the same
    points all but one (vertex clustering: J. Rossignac and P. Borrel, Multi-resolution
    3D approximations for rendering complex scenes, 1993).
    """
    cells = np.floor(surface.points_m / cell_m).astype(np.int64)
    kept, cell_of_point = _distinct(cells)
    triangles = cell_of_point[surface.triangles]
    before = np.roll(triangles, 1, axis=1)
    triangles = triangles[(triangles != before).all(axis=1)]
    once, _ = _distinct(np.sort(triangles, axis=1))
    return Surface(surface.points_m[kept], triangles[np.sort(once)])


def _shaded(surface: Surface) -> tuple[FloatArray, IntArray, FloatArray]:
    """Points, triangles and the points' normals: Rerun does not shade without them.

    A point where triangles face to different sides (of a cube around it) becomes one
    point for each side, so that edges stay sharp and round surfaces smooth.
    """
    corners_m = surface.points_m[surface.triangles]
    area = np.cross(
        corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0]
    )
    axis = np.abs(area).argmax(axis=1)
    side = 2 * axis + (np.take_along_axis(area, axis[:, None], axis=1)[:, 0] > 0)
    faces = np.stack([surface.triangles.ravel(), np.repeat(side, 3)], axis=1)
    first, which = _distinct(faces)
    normals = np.zeros((len(first), 3))
    np.add.at(normals, which, np.repeat(area, 3, axis=0))
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0, length, 1.0)
    return surface.points_m[faces[first, 0]], which.reshape(-1, 3), normals


def _distinct(rows: IntArray) -> tuple[IntArray, IntArray]:
    """Rows that differ, each where it is first, and which of these each row is."""
    low = rows.min(axis=0, initial=0)
    size = rows.max(axis=0, initial=0) - low + 1
    # One number for three: sorting whole rows takes ten times as long.
    number = np.ravel_multi_index((rows - low).T, tuple(size.tolist()))
    _, first, which = np.unique(number, return_index=True, return_inverse=True)
    return first, which


def _surface(mesh: VisualMesh) -> Surface | None:
    """What is in a file, in the joint's frame; None if it cannot be read."""
    try:
        surface = mesh_surface(mesh.path)
    except BadModelError:
        return None
    turn = Rotation.from_quat(mesh.orientation, scalar_first=True).as_matrix()
    return surface.moved(turn * mesh.scale, np.array(mesh.position_m))
