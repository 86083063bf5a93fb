"""Data of a walk drawn as stick figures: limbs, and the moments that are shown."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from robots.description import Capsule, Description, Foot
from worlds import TICK_S
from worlds.scenes.scene import SIDES, LinkPoses, Scene

NAO_HEAD_M = 0.056
"""Radius of the NAO's head [m], scaled to robots whose model has no shapes."""


@dataclass(frozen=True, eq=False)
class StickFigure:
    """Lines through a robot's joints at each tick, in the world frame [m].

    Attributes:
      legs: for "left" and "right" (ticks, points, 3) points of a line: hip, knee,
        ankle, heel, toe and back to the ankle.
      arms: for each other limb (ticks, points, 3) points from first joint to tip.
      torso: (ticks, 3, 3) middle between the hips, that between the shoulders, and the
        centre of the head.
      head_radius_m: radius of the head.
    """

    legs: dict[str, FloatArray]
    arms: list[FloatArray]
    torso: FloatArray
    head_radius_m: float


def stick_figure(scene: Scene) -> StickFigure:
    """Compute the stick figure of a scene; NaN at ticks where a value is missing."""
    robot, poses = scene.description, scene.link_poses()
    feet = dict(zip(SIDES, robot.feet, strict=True))
    legs = {side: _leg(robot, poses, foot) for side, foot in feet.items()}
    arms = [_arm(robot, poses, tip) for tip in _other_tips(robot)]
    head = _head(robot)
    root = poses[robot.root.name]
    hips = np.mean([leg[:, 0] for leg in legs.values()], axis=0)
    head_m = _point(root, _middle_m(head))
    shoulders = np.mean([arm[:, 0] for arm in arms], axis=0) if arms else head_m
    torso = np.stack([hips, shoulders, head_m], axis=1)
    return StickFigure(legs, arms, torso, head.radius_m)


def _leg(robot: Description, poses: dict[str, LinkPoses], foot: Foot) -> FloatArray:
    sole = poses[robot.links[foot.joint].link.name]
    heel_m, toe_m = (
        _point(sole, (x_m, 0.0, foot.sole_height_m))
        for x_m in (foot.outline_m[:, 0].min(), foot.outline_m[:, 0].max())
    )
    ends = [heel_m, toe_m, sole.position_m]
    return np.stack([*_joints(robot, poses, foot.joint), *ends], axis=1)


def _arm(robot: Description, poses: dict[str, LinkPoses], tip: int) -> FloatArray:
    link = robot.links[tip].link
    ends = [_middle_m(shape) for shape in link.shapes] or [(0.0, 0.0, 0.0)]
    hand_m = _point(poses[link.name], max(ends, key=lambda end: np.hypot.reduce(end)))
    return np.stack([*_joints(robot, poses, tip), hand_m], axis=1)


def _other_tips(robot: Description) -> list[int]:
    """Indices of the joints whose links carry no other joint and no foot."""
    carriers = {joint.parent for joint in robot.links}
    carriers |= {foot.joint for foot in robot.feet}
    return [joint for joint in range(len(robot.links)) if joint not in carriers]


def _joints(
    robot: Description, poses: dict[str, LinkPoses], joint: int
) -> list[FloatArray]:
    """Positions (ticks, 3) [m] of each joint on the way from the root to `joint`."""
    links = [robot.links[above].link for above in robot.chain(joint)]
    return [poses[link.name].position_m for link in links]


def _point(pose: LinkPoses, place_m: Sequence[float]) -> FloatArray:
    """(ticks, 3) world positions [m] of a point given in the frame of a link."""
    return pose.points(np.array([place_m]))[:, 0]


def _head(robot: Description) -> Capsule:
    """The root link's highest shape; without shapes, a sphere at its centre of mass."""
    x_m, y_m, z_m = robot.root.inertial.com_m.tolist()
    centre_m = (x_m, y_m, z_m)
    stand_in = Capsule(centre_m, centre_m, NAO_HEAD_M * robot.scale.length)
    return max(
        robot.root.shapes,
        key=lambda shape: max(shape.start_m[2], shape.end_m[2]) + shape.radius_m,
        default=stand_in,
    )


def _middle_m(shape: Capsule) -> tuple[float, ...]:
    """Centre of a capsule [m]."""
    return tuple(np.mean([shape.start_m, shape.end_m], axis=0).tolist())


COURSE_M, LONGEST_S = 1.0, 5.0
"""Largest distance [m] and duration [s] of the part of a walk that is shown."""

WIDTH_M = 1.5
"""Width of the picture [m]: 1 m of walk, and room for arms, legs and a fall."""

STILL_S = 0.12
"""Time between two stills, the stick figures of a picture [s]: about half a step."""

_ROOM = 2.9
"""Least distance between the heads of two bold stick figures, in radii of the head, so
that the figures and their times do not overlap."""

_GROUND_POINTS = 500


@dataclass(frozen=True, eq=False)
class WalkStrip:
    """Part of a walk, at most 1 m and 5 s: its end if it ended early, else its middle.

    Attributes:
      title: name and speed of the whole walk, and the reason if it ended early.
      ended: whether the walk ended early, such as by a fall.
      time_s: (ticks,) times of all ticks.
      figure: the robot as a stick figure at all ticks.
      ticks: the part that is shown, as a slice of the ticks.
      x_range_m: first and last x that are shown.
      stills: (stills,) ticks at which the figure is drawn, 0.12 s apart.
      clear: those of the stills whose figures do not overlap; they are drawn bold.
      ground_m: for "left" and "right" (points, 2) x and z of the ground under the path
        of that foot; empty if the ground is unknown.
    """

    title: str
    ended: bool
    time_s: FloatArray
    figure: StickFigure
    ticks: slice
    x_range_m: tuple[float, float]
    stills: IntArray
    clear: IntArray
    ground_m: dict[str, FloatArray]

    @property
    def z_range_m(self) -> tuple[float, float]:
        """Lowest and highest z to show [m]: from the ground (or 0) to the heads."""
        head_m = self.figure.torso[self.ticks, -1, 2] + self.figure.head_radius_m
        lowest_m = min((line[:, 1].min() for line in self.ground_m.values()), default=0)
        return float(lowest_m), float(np.nanmax(head_m))


def walk_strip(scene: Scene) -> WalkStrip:
    """Choose the part of a walk to show, and prepare it for drawing."""
    recording = scene.recording
    time_s, end = recording.time_s, recording.metadata.end
    x_m = recording.vector("base.position")[:, 0]
    ticks = _piece(time_s, x_m, bool(end))
    middle_m = (x_m[ticks].min() + x_m[ticks].max()) / 2
    x_range_m = float(middle_m - WIDTH_M / 2), float(middle_m + WIDTH_M / 2)
    figure = stick_figure(scene)
    shown_s = time_s[ticks]
    times_s = np.arange(shown_s[-1], shown_s[0] - TICK_S / 2, -STILL_S)[::-1]
    stills = np.searchsorted(shown_s, times_s - TICK_S / 2) + ticks.start
    speed_cm_s = 100 * (x_m[-1] - x_m[0]) / max(recording.duration_s, TICK_S)
    title = f"{scene.name.replace('/', ', ')}: {speed_cm_s:.1f} cm/s"
    return WalkStrip(
        title=f"{title}, {end} at {time_s[-1]:.1f} s" if end else title,
        ended=bool(end),
        time_s=time_s,
        figure=figure,
        ticks=ticks,
        x_range_m=x_range_m,
        stills=stills,
        clear=_apart(figure.torso[:, -1, 0], stills, _ROOM * figure.head_radius_m),
        ground_m=_ground(scene, figure, ticks, x_range_m),
    )


def _piece(time_s: FloatArray, x_m: FloatArray, ended: bool) -> slice:
    """The ticks to show: at the walk's end if `ended`, else in its middle."""
    stop = len(x_m)
    if not ended:
        middle = stop // 2
        far = np.abs(x_m[middle:] - x_m[middle]) >= COURSE_M / 2
        far |= time_s[middle:] - time_s[middle] >= LONGEST_S / 2
        stop = middle + int(far.argmax()) if far.any() else stop
    back_m = x_m[:stop][::-1]
    span_m = np.maximum.accumulate(back_m) - np.minimum.accumulate(back_m)
    near = int(np.searchsorted(span_m, COURSE_M, side="right"))
    recent = int(np.searchsorted(time_s, time_s[stop - 1] - LONGEST_S))
    return slice(max(stop - near, recent), stop)


def _apart(x_m: FloatArray, stills: IntArray, room_m: float) -> IntArray:
    """Choose stills, from the last one back, whose heads are `room_m` [m] apart."""
    chosen: list[int] = []
    for still in stills[::-1].tolist():
        if (np.abs(x_m[chosen] - x_m[still]) >= room_m).all():
            chosen.append(still)
    return np.array(chosen)


def _ground(
    scene: Scene, figure: StickFigure, ticks: slice, x_range_m: tuple[float, float]
) -> dict[str, FloatArray]:
    """By side (points, 2) x and z of the ground [m] under the path of the foot."""
    if scene.ground is None:
        return {}
    x_m = np.linspace(*x_range_m, _GROUND_POINTS)
    lines_m = {}
    for side, leg_m in figure.legs.items():
        ankle_m = leg_m[ticks, -1]
        nearest = np.abs(x_m[:, np.newaxis] - ankle_m[:, 0]).argmin(axis=1)
        z_m = scene.ground.height_at(x_m, ankle_m[nearest, 1])
        lines_m[side] = np.stack([x_m, z_m], axis=1)
    return lines_m
