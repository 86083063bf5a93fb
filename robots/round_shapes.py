"""Capsules for a robot that has none: along its bones, as thick as they are heavy."""

import math

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Capsule
from robots.posed_tree import PosedTree

DENSITY_KG_M3 = 1000.0
"""Of water, and about that of robots."""

_THINNEST, _THICKEST = 0.02, 0.09
"""Radii in units of the robot's height over its soles."""

_SHORTEST_M = 0.01
_BALL = 0.005
"""An end of the tree is drawn as a ball if it has this part of the robot's mass."""


def round_shapes(posed: PosedTree, joint: str, height_m: float) -> tuple[Capsule, ...]:
    """What moves with a joint as capsules, in its frame.

    There is a capsule from each of the file's joints to those that hang on it, and a
    ball where nothing hangs on a link with mass. The capsules of a link share its
    volume.

    Args:
      posed: the robot.
      joint: the joint, "" for the root.
      height_m: of the root over the soles; bounds the radii.
    """
    most_m = _THICKEST * height_m
    ball_kg = _BALL * posed.hanging("").mass_kg
    shapes: list[Capsule] = []
    for link in posed.carried(joint):
        mass = 0.0 if link.inertial is None else link.inertial.mass_kg
        bones = _bones_m(posed, link.name)
        total_m = sum(float(np.linalg.norm(end - start)) for start, end in bones)
        if bones:
            thick_m = math.sqrt(mass / (DENSITY_KG_M3 * math.pi * total_m))
            radius_m = min(max(thick_m, _THINNEST * height_m), most_m)
        elif link.inertial is not None and mass > ball_kg:
            centre = posed.placed[link.name].points(link.inertial.com_m)
            bones = [(centre, centre)]
            thick_m = (3 * mass / (4 * math.pi * DENSITY_KG_M3)) ** (1 / 3)
            radius_m = min(thick_m, most_m)
        origin_m = posed.origin_m(joint)
        shapes += [
            _capsule(start - origin_m, end - origin_m, radius_m) for start, end in bones
        ]
    return tuple(shapes)


def _bones_m(posed: PosedTree, link: str) -> list[tuple[FloatArray, FloatArray]]:
    """From a link's joint to those that it carries, in the root's frame."""
    start = posed.placed[link].position_m
    ends = _ends(posed, link)
    return [(start, end) for end in ends if np.linalg.norm(end - start) > _SHORTEST_M]


def _ends(posed: PosedTree, link: str) -> list[FloatArray]:
    """Where the joints of a link are that carry any mass."""
    return [
        posed.placed[joint.child].position_m
        for joint in posed.tree.joints.values()
        if joint.parent == link and _carries_mass(posed, joint.child)
    ]


def _carries_mass(posed: PosedTree, link: str) -> bool:
    if posed.tree.links[link].inertial is not None:
        return True
    return any(
        _carries_mass(posed, joint.child)
        for joint in posed.tree.joints.values()
        if joint.parent == link
    )


def _capsule(start: FloatArray, end: FloatArray, radius_m: float) -> Capsule:
    (ax, ay, az), (bx, by, bz) = start.tolist(), end.tolist()
    return Capsule((ax, ay, az), (bx, by, bz), float(radius_m))
