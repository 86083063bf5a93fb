"""Turns a robot's link into triangles, from its mesh files or from its capsules.

Rerun 0.41 can draw a mesh at many poses, but not capsules: it draws the first capsule
at the first pose and the second one at the second.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError
from robots.description import Capsule, Link, VisualMesh
from robots.from_urdf.mesh_files import joined, read_mesh
from worlds.scenes.colours import Colour
from worlds.scenes.shapes import Mesh, capsules

if TYPE_CHECKING:
    from trimesh import Trimesh

CELL_M = 0.003
"""Details smaller than this [m] are not drawn: mesh files have every screw, which would
make a .rrd file megabytes larger."""

_CAPSULE_SECTIONS = (6, 16)
"""Number of sections of a capsule's mesh from pole to pole, and around its axis."""


def link_mesh(link: Link, colour: Colour) -> Mesh | None:
    """Join all readable mesh files of a link, without details below `CELL_M`.

    None if there are no triangles, so that the link's capsules must be drawn.
    """
    found = [mesh for mesh in map(_placed, link.meshes) if mesh is not None]
    whole = coarse(joined(found))
    if not len(whole.faces):
        return None
    return Mesh(*_shaded(whole), albedo_factor=colour)


def coarse(mesh: "Trimesh", cell_m: float = CELL_M) -> "Trimesh":
    """Simplify a mesh: all points in one cubic cell become the first one of them.

    Triangles that shrink to a line or a point are dropped, and so are duplicates
    (vertex clustering: J. Rossignac and P. Borrel, Multi-resolution 3D approximations
    for rendering complex scenes, 1993). trimesh's own simplification needs one more
    library and a closed surface. `cell_m` is the length of a cell's edge.
    """
    import trimesh

    cells = np.floor(mesh.vertices / cell_m).astype(np.int64)
    first, cell_of_point = _distinct(cells)
    faces = cell_of_point[mesh.faces]
    simple = trimesh.Trimesh(mesh.vertices[first], faces, process=False)
    corners = np.sort(faces, axis=1)
    simple.update_faces(
        (corners[:, 1:] != corners[:, :-1]).all(axis=1) & simple.unique_faces()
    )
    return simple


def capsule_mesh(shapes: Sequence[Capsule], accent: Colour) -> Mesh:
    """Join a link's capsules, at least one, into a mesh in the frame of its joint.

    `accent` is the colour that marks the robot.
    """
    import trimesh

    found = capsules(shapes, accent)
    parts, normals = [], []
    for length, radius, start, quaternion in zip(*found[:4], strict=True):
        part = trimesh.creation.capsule(length, radius, _CAPSULE_SECTIONS)
        # trimesh centres a capsule, but `start` is one end of its axis.
        part.apply_translation([0.0, 0.0, length / 2])
        on_axis_m = np.clip(part.vertices, 0.0, (0.0, 0.0, length))
        turn = Rotation.from_quat(quaternion)
        normals.append(turn.apply((part.vertices - on_axis_m) / radius))
        parts.append(part.apply_transform(_placement(start, turn)))
    whole = joined(parts)
    return Mesh(
        vertex_positions=whole.vertices,
        triangle_indices=whole.faces,
        vertex_normals=np.vstack(normals),
        vertex_colors=np.repeat(found.colors, list(map(len, normals)), axis=0),
    )


def _shaded(mesh: "Trimesh") -> tuple[FloatArray, IntArray, FloatArray]:
    """Points (points, 3) [m], triangles (triangles, 3) and normals (points, 3).

    A point is split if its triangles face different sides of a cube, so that edges stay
    sharp and round surfaces smooth; trimesh's own `smooth_shade` is slower.
    """
    area = np.cross(*np.diff(mesh.triangles, axis=1).swapaxes(0, 1))
    axis = np.abs(area).argmax(axis=1)
    side = 2 * axis + (np.take_along_axis(area, axis[:, None], axis=1)[:, 0] > 0)
    point_and_side = np.stack([mesh.faces.ravel(), np.repeat(side, 3)], axis=1)
    first, point = _distinct(point_and_side)
    normals = np.zeros((len(first), 3))
    np.add.at(normals, point, np.repeat(area, 3, axis=0))
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0, length, 1.0)
    points_m = mesh.vertices[point_and_side[first, 0]]
    return points_m, point.reshape(-1, 3), normals


def _distinct(rows: IntArray) -> tuple[IntArray, IntArray]:
    """Indices of the distinct rows, and for each row, which of those equals it."""
    from trimesh.grouping import unique_rows

    first, which = unique_rows(rows)  # type: ignore[no-untyped-call]  # has no types
    return first, which


def _placed(mesh: VisualMesh) -> "Trimesh | None":
    """Read a mesh file and move it into the joint's frame; None if it is unreadable."""
    try:
        read = read_mesh(mesh.path)
    except BadModelError:
        return None
    turn = Rotation.from_quat(mesh.orientation, scalar_first=True)
    placement = _placement(mesh.position_m, turn)
    placement[:3, :3] *= mesh.scale
    return read.apply_transform(placement)


def _placement(place_m: npt.ArrayLike, turn: Rotation) -> FloatArray:
    """(4, 4) homogeneous transform of a translation (3,) [m] and a rotation."""
    placement = np.eye(4)
    placement[:3, :3], placement[:3, 3] = turn.as_matrix(), place_m
    return placement
