"""Finds the shoulders that swing the arms, and the angle at which an arm hangs."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from robots.from_urdf.leg_roles import Legs
from robots.from_urdf.placement import Placement
from robots.from_urdf.posed_tree import PosedTree
from robots.from_urdf.urdf_tree import UrdfTree

_ACROSS = math.cos(math.radians(45))
_ASIDE = 0.1
"""Smallest distance of a shoulder from the robot's middle plane, as a share of the
distance between the feet."""


def find_shoulders(
    tree: UrdfTree, placed: Mapping[str, Placement], legs: Legs, held: Sequence[str]
) -> list[str]:
    """Names of the left and right joint that swing an arm forth and back, or no names.

    A shoulder is the first moving joint on a path from the root that lies to the left
    or right of the middle; of several on one side (such as ears), the one that moves
    the most mass. Its axis must be within 45 degrees of the lateral axis.

    Args:
      tree: the robot's URDF.
      placed: placement of each link in the root link's frame.
      legs: names of the legs' joints, and the turn to x forward, y left, z up.
      held: names of joints that are held still.
    """
    feet = [placed[tree.joints[leg[-1]].child].position_m for leg in legs[:2]]
    aside_m = _ASIDE * float(np.linalg.norm(feet[0] - feet[1]))
    found: dict[int, tuple[float, str]] = {}
    for joint in tree.joints.values():
        if not joint.moving or joint.name in {*legs.left, *legs.right, *held}:
            continue
        y_m = float(legs.turn[1] @ placed[joint.child].position_m)
        above = [tree.joints[name] for name in tree.chain(joint.parent)]
        first = all(
            abs(legs.turn[1] @ placed[one.child].position_m) < aside_m for one in above
        )
        if abs(y_m) < aside_m or not first:
            continue
        side = 1 if y_m > 0 else -1
        found[side] = max(
            found.get(side, (0.0, "")), (_mass_kg(tree, joint.child), joint.name)
        )
    names = [found[side][1] for side in (1, -1) if side in found]
    if len(names) < 2 or not all(_swings(tree, placed, legs, name) for name in names):
        return []
    return names


def hanging_rad(posed: PosedTree, joint: str) -> float:
    """Angle in a shoulder joint's range [rad] at which the arm hangs lowest.

    With the joint's axis a, the vector c from the joint to the arm's centre of mass and
    c_a its part along a, the centre's height at the angle q is
    z(q) = (c_a)_z + cos(q) (c - c_a)_z + sin(q) (a x c)_z. It is least where
    (cos(q), sin(q)) points against ((c - c_a)_z, (a x c)_z).
    """
    axis = posed.axis(joint)
    arm_m = posed.hanging(joint).com_m - posed.origin_m(joint)
    across_m = arm_m - (arm_m @ axis) * axis
    lowest = math.atan2(-np.cross(axis, arm_m)[2], -across_m[2])
    low, high = posed.tree.joints[joint].range_rad
    return float(np.clip(lowest, low, high))


def _swings(
    tree: UrdfTree, placed: Mapping[str, Placement], legs: Legs, name: str
) -> bool:
    joint = tree.joints[name]
    axis = legs.turn @ placed[joint.child].rotation @ joint.axis
    return bool(abs(axis[1]) > _ACROSS)


def _mass_kg(tree: UrdfTree, link: str) -> float:
    """Mass [kg] of a link and of all links below it."""
    own = tree.links[link].inertial
    below = (joint.child for joint in tree.joints.values() if joint.parent == link)
    return (own.mass_kg if own else 0.0) + sum(_mass_kg(tree, name) for name in below)
