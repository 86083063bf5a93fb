"""Finds the legs of a URDF, and the direction in which the robot faces.

Names of joints play no part. The feet are the two lowest ends of the tree of moving
joints; a leg consists of the joints above one foot but not above the other: three at
the hip, the knee, two at the ankle (`leg_axes` finds the role of each). Knees bend one
way: the robot faces in the direction in which a knee moves when it bends.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError, UnknownNameError
from robots.from_urdf.adaptation import Adaptation
from robots.from_urdf.urdf_tree import Placement, UrdfTree
from robots.leg_geometry import KNEE, ROLES

_FACING = {"x": (1.0, 0.0), "-x": (-1.0, 0.0), "y": (0.0, 1.0), "-y": (0.0, -1.0)}
_CLEAR = 0.9


class Legs(NamedTuple):
    """The legs of a robot.

    Attributes:
      left, right: names of the leg's joints from the hip to the foot.
      turn: (3, 3) rotation from the root link's frame to x forward, y left, z up.
    """

    left: tuple[str, ...]
    right: tuple[str, ...]
    turn: FloatArray


def find_legs(
    tree: UrdfTree, placed: Mapping[str, Placement], adaptation: Adaptation
) -> Legs:
    """Find the legs from the kinematics, unless the adaptation names them.

    `placed` holds each link's placement in the root link's frame, in which z is up.

    Raises:
      BadModelError: there are no two legs of six joints, or the knees' ranges do not
        show which way is forward.
    """
    for name in adaptation.joints():
        if name not in tree.joints:
            raise UnknownNameError(f"joint of {tree.path.name}", name, tree.joints)
    if adaptation.left_leg:
        one, other = (
            _in_order(tree, leg) for leg in (adaptation.left_leg, adaptation.right_leg)
        )
    else:
        one, other = _legs(tree, placed, adaptation.held)
    places = [placed[tree.joints[leg[-1]].child].position_m for leg in (one, other)]
    across = (places[0] - places[1])[:2]
    if np.linalg.norm(across) < 1e-3:
        raise BadModelError(f"{tree.path}: the feet are in one place")
    across = across / np.linalg.norm(across)
    forward = adaptation.forward or _facing(tree, placed, (one, other), across)
    x, y = _FACING[forward]
    turn = np.array([[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]])
    is_left = float(across @ turn[1, :2]) > 0
    if adaptation.left_leg and not is_left:
        raise BadModelError(f"{tree.path}: facing {forward}, the left leg is the right")
    return Legs(*((one, other) if is_left else (other, one)), turn)


def _in_order(tree: UrdfTree, leg: Sequence[str]) -> tuple[str, ...]:
    """Sort the names of a leg's joints from the hip to the foot."""
    deepest = max(leg, key=lambda name: len(tree.chain(tree.joints[name].child)))
    chain = tree.chain(tree.joints[deepest].child)
    if not set(leg) <= set(chain):
        raise BadModelError(f"{tree.path}: {', '.join(leg)} are not one chain")
    return tuple(name for name in chain if name in leg)


def _legs(
    tree: UrdfTree, placed: Mapping[str, Placement], held: Sequence[str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the six joints of each leg, from hip to foot; the legs in any order."""
    free = [one for one in tree.joints.values() if one.moving and one.name not in held]
    carriers = {name for joint in free for name in tree.chain(joint.parent)}
    ends = [joint for joint in free if joint.name not in carriers]
    ends.sort(key=lambda joint: float(placed[joint.child].position_m[2]))
    if len(ends) < 2:
        raise BadModelError(f"{tree.path}: a robot that walks needs two feet")
    chains = [
        [name for name in tree.chain(joint.child) if name not in held]
        for joint in ends[:2]
    ]
    left, right = (
        tuple(name for name in chain if name not in other)
        for chain, other in (chains, chains[::-1])
    )
    for leg in (left, right):
        if len(leg) != len(ROLES):
            raise BadModelError(
                f"{tree.path}: a leg has {len(leg)} joints ({', '.join(leg)}); it "
                f"needs six ({', '.join(ROLES)}): hold the others, or name them"
            )
    return left, right


def _facing(
    tree: UrdfTree,
    placed: Mapping[str, Placement],
    legs: Sequence[Sequence[str]],
    across: FloatArray,
) -> str:
    """Direction "x", "-x", "y" or "-y" in which the knees move when they bend.

    A knee with the range [a, b] about an axis can bend by a + b more one way than the
    other. A positive turn about an axis that points left swings the shin backward.
    """
    bend = np.zeros(3)
    for leg in legs:
        joint = tree.joints[leg[KNEE]]
        bend += sum(joint.range_rad) * (placed[joint.child].rotation @ joint.axis)
    if abs(float(bend[:2] @ across)) < 0.1:
        raise BadModelError(
            f"{tree.path}: the knees bend both ways alike; say which way is forward"
        )
    left = across * np.sign(bend[:2] @ across)
    forward = np.array([left[1], -left[0]])
    name = max(_FACING, key=lambda known: float(forward @ _FACING[known]))
    if forward @ _FACING[name] < _CLEAR:
        raise BadModelError(f"{tree.path}: the robot faces neither along x nor along y")
    return name
