"""Round shapes as triangles: a viewer repeats meshes at many poses, capsules it cannot.

Rerun 0.41 draws a mesh at each of an entity's instance poses. Of capsules it draws the
first at the first pose, the second at the second.
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray, IntArray
from robots.description import Capsule
from worlds.scenes.colours import Colour
from worlds.scenes.shapes import Mesh, capsules

AROUND, RINGS = 16, 4
"""Points around a capsule's axis, and rings from the pole of an end to its rim."""


def capsule_mesh(shapes: Sequence[Capsule], accent: Colour) -> Mesh:
    """A link's shapes as one mesh in the frame of its joint.

    Args:
      shapes: at least one.
      accent: see `shape_colours`.
    """
    found = capsules(shapes, accent)
    outward, is_upper = _directions()
    turned = Rotation.from_quat(found.quaternions).as_matrix() @ outward.T
    normals = turned.mT
    axes = Rotation.from_quat(found.quaternions).apply([0.0, 0.0, 1.0])
    points_m = found.radii[:, np.newaxis, np.newaxis] * normals
    points_m = points_m + found.translations[:, np.newaxis]
    along_m = (found.lengths[:, np.newaxis] * axes)[:, np.newaxis]
    points_m = points_m + is_upper[:, np.newaxis] * along_m
    one = _triangles()
    starts = len(outward) * np.arange(len(shapes))
    return Mesh(
        vertex_positions=points_m.reshape(-1, 3),
        triangle_indices=(starts[:, np.newaxis, np.newaxis] + one).reshape(-1, 3),
        vertex_normals=normals.reshape(-1, 3),
        vertex_colors=np.repeat(found.colors, len(outward), axis=0),
    )


def _directions() -> tuple[FloatArray, FloatArray]:
    """(points, 3) unit vectors from ring to ring upward; (points,) 1 on the upper end.

    The rim is there twice, once for each end.
    """
    end = np.linspace(0, np.pi / 2, RINGS)
    latitude = np.concatenate([end - np.pi / 2, end])[:, np.newaxis]
    around = 2 * np.pi * np.arange(AROUND) / AROUND
    x, y = np.cos(latitude) * np.cos(around), np.cos(latitude) * np.sin(around)
    z = np.broadcast_to(np.sin(latitude), x.shape)
    is_upper = np.repeat([0.0, 1.0], RINGS * AROUND)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), is_upper


def _triangles() -> IntArray:
    """(triangles, 3) between the rings, counterclockwise seen from outside."""
    index = np.arange(2 * RINGS * AROUND).reshape(2 * RINGS, AROUND)
    after = np.roll(index, -1, axis=1)
    right = np.stack([index[:-1], after[:-1], after[1:]], axis=-1)
    left = np.stack([index[:-1], after[1:], index[1:]], axis=-1)
    # All points of a ring at a pole are the same: there one of the two is a line.
    return np.vstack([right[1:].reshape(-1, 3), left[:-1].reshape(-1, 3)])
