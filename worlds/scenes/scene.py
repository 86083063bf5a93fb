"""`Scene`: a recording together with its robot, the poses of its links, and its ground.

In forward kinematics a missing value (NaN) gives a NaN pose; SciPy's `Rotation` would
refuse it.
"""

import hashlib
import itertools
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadRecordingError, BadValueError
from robots.description import Description
from terrain import Heightfield
from worlds.recordings.recording import ORIENTATION, Recording, nearest


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


SIDES = ("left", "right")
_NAO_ARROW_M_PER_N = 0.005
_NAME = re.compile(r"[A-Za-z0-9][\w.-]*(/[A-Za-z0-9][\w.-]*)*", re.ASCII)


@dataclass(frozen=True, eq=False)
class Scene:
    """A recording with its robot and its ground, ready to be drawn.

    The name, such as "sim" or "start/real", begins all paths in a viewer; BadValueError
    if it is no path of letters, digits, `_`, `-` and `.`. The ground is None if there
    was none or it is unknown. BadRecordingError if the robot lacks a recorded joint.

    Example:
      >>> Scene("sim", read_recording(Path("walk.parquet")), robots.get("nao")).title
    """

    name: str
    recording: Recording
    description: Description
    ground: Heightfield | None = None

    def __post_init__(self) -> None:
        """Check the name, and that the robot has all recorded joints."""
        if not _NAME.fullmatch(self.name):
            raise BadValueError(
                f"scene name {self.name!r}: it must be made of letters, digits, '_', "
                "'-' and '.', its parts with '/' between them, such as 'start/sim'"
            )
        known = self.description.joints
        for joint in self.recording.joints:
            if joint not in known:
                raise BadRecordingError(
                    f"{self.name}: the recording has the joint {joint!r}, which robot "
                    f"{self.description.name} has not{nearest(joint, known)}"
                )

    @property
    def arrow_m_per_n(self) -> float:
        """Arrow length per force [m/N]: a robot's weight looks as long as its legs."""
        scale = self.description.scale
        return _NAO_ARROW_M_PER_N * scale.length / scale.weight

    def link_poses(self) -> dict[str, LinkPoses]:
        """Poses of all links by name, at each tick; NaN where a value is missing.

        A base that was not recorded is upright at the world's origin, and a joint that
        was not recorded is at 0.
        """
        recorded, joints = self.recording.joints, self.description.joints
        position_rad = np.zeros((self.recording.ticks, len(joints)))
        columns = [joints.index(joint) for joint in recorded]
        position_rad[:, columns] = self.recording.joint_values("position", recorded)
        base = LinkPoses(
            self._vector("base.position", (0.0, 0.0, 0.0)),
            self._vector(ORIENTATION, (1.0, 0.0, 0.0, 0.0)),
        )
        return link_poses(self.description, position_rad, base)

    def foot_force_n(self, side: str) -> FloatArray | None:
        """(ticks,) force [N] on the foot "left" or "right"; None if not recorded."""
        if self.recording.has("foot_force"):
            return self.recording.columns[f"foot_force.{side}"]
        if self.recording.has(f"foot_force.{side}"):
            return np.asarray(self.recording.vector(f"foot_force.{side}").sum(axis=1))
        return None

    def sensor_forces_n(self, side: str) -> tuple[FloatArray, FloatArray] | None:
        """Places and forces of the force sensors of the foot "left" or "right".

        The points (k, 3) are on the sole, in the foot's frame [m], the forces (ticks,
        k) in N. There is one point in the middle if only the sum of the four sensors'
        forces was recorded, and None if no forces were.
        """
        foot = self.description.feet[SIDES.index(side)]
        points_xy_m = foot.sensors_m
        if self.recording.has(f"foot_force.{side}"):
            forces_n = self.recording.vector(f"foot_force.{side}")
        else:
            total_n = self.foot_force_n(side)
            if total_n is None:
                return None
            forces_n = total_n[:, np.newaxis]
            points_xy_m = points_xy_m.mean(axis=0, keepdims=True)
        height_m = np.full((len(points_xy_m), 1), foot.sole_height_m)
        return np.hstack([points_xy_m, height_m]), forces_n

    def pitch_joints(self, side: str) -> tuple[str, ...]:
        """Names of the recorded pitch joints of a leg ("left", "right"), hip first."""
        robot = self.description
        if not robot.feet:
            return ()
        chain = robot.chain(robot.feet[SIDES.index(side)].joint)
        links = [robot.links[joint] for joint in chain]
        return tuple(
            joint.name
            for joint in links
            if abs(joint.axis[1]) > 0.9 and joint.name in self.recording.joints
        )

    @property
    def title(self) -> str:
        """The scene's name and, if it is known, how and when the rollout ended."""
        end = self.recording.metadata.end
        if not end:
            return self.name
        return f"{self.name}: {end} at {self.recording.time_s[-1]:.2f} s"

    @property
    def properties(self) -> dict[str, str]:
        """The recording's known metadata as text, by name."""
        about = self.recording.metadata
        known = {
            "robot": about.robot,
            "base": about.base,
            "source": about.source,
            "world": about.world,
            "end": about.end,
            "gait": about.gait and json.dumps(about.gait),
            "terrain": about.terrain and json.dumps(about.terrain),
        }
        return {name: text for name, text in known.items() if text}

    def _vector(self, name: str, otherwise: Sequence[float]) -> FloatArray:
        """(ticks, k) values of a recorded vector, or `otherwise` (k,) at each tick."""
        if self.recording.has(name):
            return self.recording.vector(name)
        return np.tile(otherwise, (self.recording.ticks, 1))


def check_beside(scenes: Sequence[Scene]) -> None:
    """Raise BadValueError if there are no scenes, or names cannot be paths in one file.

    A scene's name may be neither that of another one nor the start of its path.
    """
    if not scenes:
        raise BadValueError("no scenes; at least one recording is needed")
    paths = sorted(f"{scene.name}/" for scene in scenes)
    for path, after in itertools.pairwise(paths):
        if after.startswith(path):
            raise BadValueError(
                f"scenes {path[:-1]!r} and {after[:-1]!r}: a name must not be another "
                "one's, nor the start of its path"
            )


def content_id(scenes: Sequence[Scene]) -> str:
    """Hash of scenes: 32 hexadecimal digits of their recordings, names and grounds."""
    content = hashlib.sha256()
    for scene in scenes:
        content.update(f"{scene.name}\n{scene.description.name}\n".encode())
        content.update(scene.recording.metadata.to_json().encode())
        for name, values in scene.recording.columns.items():
            content.update(f"\n{name}\n".encode() + values.tobytes())
        if scene.ground is not None:
            content.update(
                f"\n{scene.ground.origin_m} {scene.ground.spacing_m}\n".encode()
            )
            content.update(scene.ground.heights_m.tobytes())
    return content.hexdigest()[:32]
