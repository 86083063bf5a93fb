"""Finds the legs and arms of a URDF, the direction it faces, and how it balances.

Names of joints play no part. The feet are the two lowest ends of the tree of moving
joints; a leg consists of the joints above one foot but not above the other: three at
the hip, the knee, two at the ankle (`leg_geometry.roles` finds the role of each). Knees
bend one way: the robot faces in the direction in which a knee moves when it bends.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError, UnknownNameError
from robots.description import Foot
from robots.from_urdf.adaptation import Adaptation
from robots.from_urdf.posed_tree import PosedTree
from robots.from_urdf.urdf_tree import Placement, UrdfTree
from robots.leg_geometry import KNEE, ROLES

_FACING = {"x": (1.0, 0.0), "-x": (-1.0, 0.0), "y": (0.0, 1.0), "-y": (0.0, -1.0)}
_CLEAR = 0.9


class Legs(NamedTuple):
    """Names of both legs' joints from hip to foot, and the robot's rotation.

    The rotation (3, 3) turns the root link's frame to x forward, y left, z up.
    """

    left: tuple[str, ...]
    right: tuple[str, ...]
    turn: FloatArray


def find_legs(
    tree: UrdfTree, placed: Mapping[str, Placement], adaptation: Adaptation
) -> Legs:
    """Find the legs from the kinematics, unless the adaptation names them.

    `placed` holds each link's placement in the root link's frame, in which z is up.
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


SOLE_PART, HIP_PART, HIPS_AHEAD_M = 0.43, 0.927, 0.010
"""Posture of the NAO in the gait Walk2014 of the team rUNSWift: place of the centre of
mass over the sole, as a share of the distance from heel to toe; height of the hips, as
a share of that with straight legs; distance of the hips ahead of the ankles [m]."""


def crouch_rad(thigh_m: float, tibia_m: float, hip_m: float) -> tuple[float, float]:
    """Hip pitch and knee [rad] of a crouched leg, its ankle `hip_m` below the hip.

    `thigh_m` is the length from hip to knee, `tibia_m` that from knee to ankle [m].
    """
    bend = (hip_m**2 - thigh_m**2 - tibia_m**2) / (2 * thigh_m * tibia_m)
    knee = math.acos(min(max(bend, -1.0), 1.0))
    behind = math.atan2(tibia_m * math.sin(knee), thigh_m + tibia_m * math.cos(knee))
    return -behind, knee


def ankles_ahead_m(
    posed: PosedTree, crouch: Mapping[str, float], foot: Foot, scale: float
) -> float:
    """Distance of the ankles ahead of the hips [m] for a gait's `com_offset` of zero.

    The distance is chosen so that with the `com_offset` of 10 mm of the gait Walk2014
    (rUNSWift), scaled to the robot, the weight is over the same part of the sole as on
    the NAO. `crouch` has angles [rad] that put the ankles below the hips, `scale` is
    the ratio of the leg length to the NAO's.
    """
    crouched = posed.in_pose(crouch)
    ankle_m = crouched.origin_m(posed.moving[foot.joint])
    heel_m, toe_m = foot.outline_m[:, 0].min(), foot.outline_m[:, 0].max()
    weight_m = crouched.hanging("").com_m[0] - ankle_m[0]
    wanted_m = heel_m + SOLE_PART * (toe_m - heel_m)
    return float(weight_m - wanted_m + HIPS_AHEAD_M * scale)


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
    the most mass. Its axis must be within 45 degrees of the lateral axis. `placed`
    holds each link's placement in the root link's frame; `held` joints do not move.
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
            found.get(side, (0.0, "")), (tree.mass_kg(joint.child), joint.name)
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
