"""Stick figures of a moving robot: lines for its limbs, its torso and its head."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Capsule, Description, Foot
from worlds.scenes.forward_kinematics import LinkPoses
from worlds.scenes.scene import SIDES, Scene

NAO_HEAD_M = 0.056
"""Radius of the NAO's head [m], scaled to robots whose model has no shapes."""


@dataclass(frozen=True, eq=False)
class StickFigure:
    """Lines through a robot's joints at each tick, in the world frame [m].

    Attributes:
      legs: for "left" and "right" (ticks, points, 3) points of a line: hip, knee,
        ankle, heel, toe and back to the ankle.
      arms: for each other limb (ticks, points, 3) points from its first joint to its
        tip.
      torso: (ticks, 3, 3) the middle between the hips, the middle between the
        shoulders, and the centre of the head.
      head_radius_m: radius of the head [m].
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
    chain: list[FloatArray] = []
    while joint >= 0:
        chain.insert(0, poses[robot.links[joint].link.name].position_m)
        joint = robot.links[joint].parent
    return chain


def _point(pose: LinkPoses, place_m: Sequence[float]) -> FloatArray:
    """(ticks, 3) world positions [m] of a point given in the frame of a link."""
    return pose.points(np.array([place_m]))[:, 0]


def _head(robot: Description) -> Capsule:
    """The root link's highest shape; without shapes, a sphere at its centre of mass."""
    x_m, y_m, z_m = robot.root.inertial.com_m.tolist()
    centre_m = (x_m, y_m, z_m)
    stand_in = Capsule(centre_m, centre_m, NAO_HEAD_M * robot.scale.length)
    return max(robot.root.shapes, key=_top_m, default=stand_in)


def _middle_m(shape: Capsule) -> tuple[float, ...]:
    """Centre of a capsule [m]."""
    return tuple(np.mean([shape.start_m, shape.end_m], axis=0).tolist())


def _top_m(shape: Capsule) -> float:
    return max(shape.start_m[2], shape.end_m[2]) + shape.radius_m
