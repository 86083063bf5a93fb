"""Finds legs, arms and foot sensors in a robot's description, for the walk engine."""

import math

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from robots.description import Description
from robots.leg_geometry import LEG_JOINTS, Biped, LegChain, LegGeometry, roles

_SAME_M = 1e-9
_ABOUT = [2, 0, 1, 1, 1, 0]
"""Index of the axis (0 x, 1 y, 2 z) about which each leg joint turns, in the order yaw,
roll, pitch, knee, ankle pitch, ankle roll."""

_Leg = tuple[int, ...]


def biped(description: Description) -> Biped:
    """Find the legs, arms and foot sensors of a robot that walks on two legs.

    A leg is the chain of joints from the root to a foot: three at the hip, the knee,
    two at the ankle; BadValueError if it is not. An arm is a joint at the root that
    belongs to no leg (shoulder pitch), with the joint after it (shoulder roll).

    Example:
      >>> biped(robots.get("nao")).leg.thigh_m
      0.1
    """
    left, right = (description.chain(foot.joint) for foot in description.feet)
    for side, leg in (("left", left), ("right", right)):
        if len(leg) != LEG_JOINTS:
            names = ", ".join(description.joints[joint] for joint in leg)
            raise BadValueError(
                f"robot {description.name}: the {side} leg has {len(leg)} joints "
                f"({names}); a walking leg needs six"
            )
    of_left, of_right = description.legs or (
        _by_role(description, left),
        _by_role(description, right),
    )
    if (of_left, of_right) == (left, right) and _meet(description, left, right):
        geometry, chains = _geometry(description, left), None
    else:
        geometry = _like(description, left, of_left)
        chains = (
            _leg_chain(description, left, of_left),
            _leg_chain(description, right, of_right),
        )
    arms = [_arm(description, {*left, *right}, side) for side in (1, -1)]
    signs = [
        math.copysign(1.0, description.links[arm[0]].axis[1]) if arm else 1.0
        for arm in arms
    ]
    return Biped(
        leg=geometry,
        left_leg=of_left,
        right_leg=of_right,
        left_arm=arms[0],
        right_arm=arms[1],
        joint_range_rad=description.joint_range_rad,
        max_speed_rad_s=description.no_load_speed_rad_s,
        foot_sensor_xy_m=np.vstack([foot.sensors_m for foot in description.feet]),
        chains=chains,
        hanging_rad=description.hanging_rad,
        arm_signs=(signs[0], signs[1]),
        scale=description.scale,
        ankles_ahead_m=description.ankles_ahead_m,
    )


def _by_role(description: Description, leg: _Leg) -> _Leg:
    axes = np.array([description.links[joint].axis for joint in leg])
    try:
        return tuple(leg[k] for k in roles(axes))
    except ValueError as error:
        raise BadValueError(f"robot {description.name}: {error}") from error


def _arm(description: Description, legs: set[int], side: int) -> _Leg | None:
    """Shoulder pitch and roll of the arm on one side (1 left, -1 right)."""
    for i, joint in enumerate(description.links):
        if joint.parent < 0 and i not in legs and joint.origin_m[1] * side > 0:
            for k, after in enumerate(description.links):
                if after.parent == i:
                    return i, k
            return (i,)
    return None


def _meet(description: Description, left: _Leg, right: _Leg) -> bool:
    """Whether hip axes meet in a point, ankle axes in another, legs are mirrored."""
    one, other = ([description.links[joint] for joint in leg] for leg in (left, right))
    axes = np.array([joint.axis for joint in one])
    expected = np.array([axes[0], *np.eye(3)[[0, 1, 1, 1, 0]]])
    origins = np.array([joint.origin_m for joint in one])
    bones = np.delete(origins, 0, axis=0)
    bones[[2, 3], 2] = 0.0  # the knee and the ankle are straight below
    mirror = np.array([1.0, -1.0, 1.0])
    same_origins = origins * mirror - np.array([joint.origin_m for joint in other])
    # The mirror image of a turn is the opposite turn about the mirrored axis.
    mirrored = -mirror * axes * np.array([1, -1, 1, 1, 1, -1])[:, None]
    same_axes = mirrored - np.array([joint.axis for joint in other])
    wrong = (axes - expected, bones, same_origins, same_axes)
    return all(np.abs(error).max() < _SAME_M for error in wrong)


def _geometry(description: Description, leg: _Leg) -> LegGeometry:
    """Geometry of a left leg whose hip axes meet in one point, and ankle axes, too."""
    yaw, _, _, knee, ankle, _ = (description.links[joint] for joint in leg)
    hip_x, hip_y, hip_z = yaw.origin_m.tolist()
    axis_x, axis_y, axis_z = yaw.axis.tolist()
    return LegGeometry(
        hip_m=(hip_x, hip_y, hip_z),
        yaw_axis=(axis_x, axis_y, axis_z),
        thigh_m=math.hypot(*knee.origin_m),
        tibia_m=math.hypot(*ankle.origin_m),
        ankle_height_m=-description.feet[0].sole_height_m,
    )


def _like(description: Description, chain: _Leg, leg: _Leg) -> LegGeometry:
    """Approximate a leg whose hip axes do not meet by a leg whose axes do.

    It has the hip on the hip pitch axis, straight above the foot, the ankle on the
    ankle pitch axis, and the thigh and shin lengths seen from the side.
    """
    at = _places(description, chain)
    _, _, pitch, knee, ankle, _ = (at[chain.index(joint)] for joint in leg)
    thigh_m, tibia_m = pitch - knee, knee - ankle
    sole_m = float(at[-1][2]) + description.feet[0].sole_height_m
    return LegGeometry(
        hip_m=(float(pitch[0]), float(at[-1][1]), float(pitch[2])),
        yaw_axis=(0.0, 0.0, 1.0),
        thigh_m=math.hypot(thigh_m[0], thigh_m[2]),
        tibia_m=math.hypot(tibia_m[0], tibia_m[2]),
        ankle_height_m=float(ankle[2]) - sole_m,
    )


def _leg_chain(description: Description, chain: _Leg, leg: _Leg) -> LegChain:
    links = [description.links[joint] for joint in chain]
    at = _places(description, chain)
    order = np.array([chain.index(joint) for joint in leg])
    axes = np.array([joint.axis for joint in links])
    _, _, pitch, knee, ankle, _ = at[order]
    # Leaning back is a negative pitch: a leg that is ahead at its lower end.
    thigh_rad = math.atan2(pitch[0] - knee[0], pitch[2] - knee[2])
    tibia_rad = math.atan2(knee[0] - ankle[0], knee[2] - ankle[2])
    return LegChain(
        origins_m=np.array([joint.origin_m for joint in links]),
        axes=axes,
        order=order,
        signs=np.sign(axes[order, _ABOUT]),
        zero_rad=np.array(
            [0.0, 0.0, thigh_rad, tibia_rad - thigh_rad, -tibia_rad, 0.0]
        ),
        foot_m=at[-1] - ankle,
    )


def _places(description: Description, chain: _Leg) -> FloatArray:
    """(6, 3) positions of a leg's joints in the torso's frame [m], all angles zero."""
    return np.cumsum([description.links[joint].origin_m for joint in chain], axis=0)
