"""Finds the sole of a foot in the collision or visual shapes of a URDF."""

from collections.abc import Iterator

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError
from robots.description import Foot
from robots.from_urdf.adaptation import SoleBox
from robots.from_urdf.mesh_files import read_mesh
from robots.from_urdf.package_paths import mesh_path
from robots.from_urdf.posed_tree import PosedTree
from robots.from_urdf.urdf_tree import UrdfShape

THICKNESS_M = 0.005
"""Points of a foot less than this height [m] above its lowest point form the sole."""

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
_AROUND = np.linspace(0, 2 * np.pi, 24, endpoint=False)


def foot(
    posed: PosedTree, joint: str, index: int, box: SoleBox | None, side: int
) -> Foot:
    """Describe a foot, whose sole is given or the bottom of its collision shapes.

    Its four force sensors are at the corners of the rectangle around the sole.

    Args:
      posed: the robot in a pose with level soles.
      joint: name of the leg's last joint.
      index: column of that joint in joint arrays.
      box: the left sole; None to take it from the shapes.
      side: 1 left, -1 right.

    Raises:
      BadModelError: the foot has no shape with a bottom.
    """
    if box is None:
        points_m = _points(posed, joint) - posed.origin_m(joint)
        height_m = float(points_m[:, 2].min())
        sole = points_m[points_m[:, 2] < height_m + THICKNESS_M, :2]
    else:
        height_m = box.height_m
        sole = np.array([[x, side * y] for x in box.x_m for y in box.y_m])
    try:
        outline_m = sole[ConvexHull(sole).vertices]
    except (QhullError, ValueError):
        raise BadModelError(
            f"{posed.tree.path}: the foot of {joint} has no flat bottom; give its sole"
        ) from None
    if height_m >= 0:
        raise BadModelError(f"{posed.tree.path}: {joint} lies below its foot's sole")
    (back, right), (front, left) = outline_m.min(axis=0), outline_m.max(axis=0)
    sensors = [[front, left], [front, right], [back, left], [back, right]]
    return Foot(index, height_m, outline_m, np.array(sensors))


def shape_points(posed: PosedTree, shape: UrdfShape) -> FloatArray:
    """(points, 3) corners of a shape in its own frame [m]; for cylinders 24-gons."""
    values = shape.values
    if shape.kind == "mesh":
        path = mesh_path(posed.tree.path, values["filename"])
        return read_mesh(path).vertices * _numbers(values.get("scale", "1 1 1"))
    if shape.kind == "box":
        return _CORNERS * _numbers(values["size"]) / 2
    radius = float(values["radius"])
    if shape.kind == "sphere":
        return radius * np.vstack([np.eye(3), -np.eye(3)])
    half = float(values["length"]) / 2
    ring = radius * np.stack([np.cos(_AROUND), np.sin(_AROUND)], axis=1)
    return np.vstack(
        [np.hstack([ring, np.full((len(ring), 1), z)]) for z in (-half, half)]
    )


def _points(posed: PosedTree, joint: str) -> FloatArray:
    """(points, 3) of a foot's collision (or visual) shapes in the root frame [m]."""
    for kind in ("collision", "visual"):
        parts = list(_of_kind(posed, joint, kind))
        if parts:
            return np.vstack(parts)
    raise BadModelError(
        f"{posed.tree.path}: the foot of {joint} has no shape; give its sole"
    )


def _of_kind(posed: PosedTree, joint: str, kind: str) -> Iterator[FloatArray]:
    for link in posed.carried(joint):
        for shape in getattr(link, kind):
            place = posed.placed[link.name] @ shape.placement
            if shape.kind == "sphere":
                place = type(place)(np.eye(3), place.position_m)
            yield place.points(shape_points(posed, shape))


def _numbers(text: str) -> FloatArray:
    return np.array(text.split(), float)
