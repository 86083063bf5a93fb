"""Loads a heightfield as ground into a PyBullet client."""

import math
from typing import Any

import numpy as np

from terrain import Heightfield

_QUARTER_TURN = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
"""Quaternion x, y, z, w of a turn by +90 degrees about the vertical."""


def load_ground(bullet: Any, field: Heightfield) -> int:
    """Load ground into a PyBullet client as a static body, a plane if it is flat.

    PyBullet cuts a cell of a heightfield into triangles along the diagonal from
    [row, column + 1] to [row + 1, column], MuJoCo and `Heightfield` along the other
    one. So the samples are turned by -90 degrees and the body by +90: heights stay in
    place, diagonals change. PyBullet counts samples along its x axis as "rows" and puts
    the middle between the lowest and the highest sample at the body's origin. Ray casts
    agree with `field.height_at` to 1e-8 m.

    Args:
      bullet: a `pybullet_utils.bullet_client.BulletClient`.
      field: heights in the world frame.

    Returns:
      PyBullet's id of the body.
    """
    (x_low, x_high), (y_low, y_high) = field.x_range_m, field.y_range_m
    lowest_m, highest_m = float(field.heights_m.min()), float(field.heights_m.max())
    middle = (
        (x_low + x_high) / 2.0,
        (y_low + y_high) / 2.0,
        (lowest_m + highest_m) / 2.0,
    )
    if field.is_flat:
        up = (0.0, 0.0, 1.0)
        plane = bullet.createCollisionShape(bullet.GEOM_PLANE, planeNormal=up)
        return int(bullet.createMultiBody(0.0, plane, basePosition=middle))
    turned_m = np.rot90(field.heights_m)
    shape = bullet.createCollisionShape(
        bullet.GEOM_HEIGHTFIELD,
        meshScale=(field.spacing_m, field.spacing_m, 1.0),
        heightfieldData=turned_m.ravel().tolist(),
        numHeightfieldRows=turned_m.shape[1],
        numHeightfieldColumns=turned_m.shape[0],
        # Without this flag feet stumble over edges between coplanar triangles.
        flags=bullet.GEOM_CONCAVE_INTERNAL_EDGE,
    )
    return int(
        bullet.createMultiBody(
            0.0, shape, basePosition=middle, baseOrientation=_QUARTER_TURN
        )
    )
