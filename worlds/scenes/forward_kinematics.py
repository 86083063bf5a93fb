"""Forward kinematics: poses of all links of a robot, for many ticks at once.

A missing value (NaN) gives a NaN pose; SciPy's `Rotation` would refuse it.
"""

from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description


class LinkPoses(NamedTuple):
    """Poses in the world of one link's frame (that of its joint), one for each tick."""

    position_m: FloatArray
    """(ticks, 3) place of the frame's origin in the world [m]."""
    orientation: FloatArray
    """(ticks, 4) unit quaternions w, x, y, z from link to world."""

    def axes(self) -> FloatArray:
        """(ticks, 3, 3) rotation matrices from link to world; NaN for a NaN pose."""
        w, x, y, z = self.orientation.T
        rows = (
            (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
        )
        return np.moveaxis(np.array(rows), -1, 0)

    def points(self, points_m: FloatArray) -> FloatArray:
        """(ticks, points, 3) world places of (points, 3) in the link's frame [m]."""
        return self.position_m[:, np.newaxis] + points_m @ self.axes().mT

    def at(self, tick: int) -> "LinkPoses":
        """The pose at one tick, as `LinkPoses` with one row."""
        return LinkPoses(self.position_m[[tick]], self.orientation[[tick]])


def link_poses(
    description: Description, position_rad: FloatArray, base: LinkPoses
) -> dict[str, LinkPoses]:
    """Poses of all links by name, the root first, from joint positions and root poses.

    T_link = T_parent * translation(origin) * rotation(axis, angle). A NaN in a joint or
    in the base makes the poses of exactly the links after it NaN. Positions (ticks,
    joints) are in the description's order, in m where a joint slides.
    """
    norm = np.linalg.norm(base.orientation, axis=1, keepdims=True)
    root = LinkPoses(base.position_m, base.orientation / norm)
    poses: list[LinkPoses] = []
    for joint, angle_rad in zip(description.links, position_rad.T, strict=True):
        parent = root if joint.parent < 0 else poses[joint.parent]
        offset_m = _rotate(parent.orientation, joint.origin_m)
        if joint.slides:
            way_m = joint.origin_m + angle_rad[:, np.newaxis] * joint.axis
            moved_m = parent.position_m + _rotate(parent.orientation, way_m)
            poses.append(LinkPoses(moved_m, parent.orientation))
            continue
        half_rad = angle_rad[:, np.newaxis] / 2
        turn = np.hstack([np.cos(half_rad), np.sin(half_rad) * joint.axis])
        poses.append(
            LinkPoses(parent.position_m + offset_m, _product(parent.orientation, turn))
        )
    names = (description.root.name, *(joint.link.name for joint in description.links))
    return dict(zip(names, (root, *poses), strict=True))


def _product(first: FloatArray, second: FloatArray) -> FloatArray:
    """(n, 4) products of quaternions w, x, y, z: first the `second` rotation acts."""
    w1, v1, w2, v2 = first[:, :1], first[:, 1:], second[:, :1], second[:, 1:]
    w = w1 * w2 - np.sum(v1 * v2, axis=1, keepdims=True)
    return np.hstack([w, w1 * v2 + w2 * v1 + np.cross(v1, v2)])


def _rotate(orientation: FloatArray, vector: FloatArray) -> FloatArray:
    """(n, 3) vectors (3,) or (n, 3), rotated by (n, 4) unit quaternions w, x, y, z."""
    w, v = orientation[:, :1], orientation[:, 1:]
    twice = 2.0 * np.cross(v, vector)
    return np.asarray(vector + w * twice + np.cross(v, twice))
