"""A description as a walk engine sees it; joint roles follow from the kinematics."""

import math

import numpy as np

from groundwalk.errors import BadValueError
from robots.description import Description
from robots.leg_geometry import LEG_JOINTS, Biped, LegGeometry


def biped(description: Description) -> Biped:
    """Legs, arms and foot sensors of a robot that walks on two legs.

    A leg is the chain of joints from the root to a foot: yaw, roll, pitch, knee,
    ankle pitch, ankle roll. An arm is a joint at the root that no leg has, with the
    joint after it: shoulder pitch and roll.

    Raises:
      BadValueError: a leg has not six joints, or its joints do not meet as they must.
    """
    left, right = (_chain(description, foot.joint) for foot in description.feet)
    for side, leg in (("left", left), ("right", right)):
        if len(leg) != LEG_JOINTS:
            names = ", ".join(description.joints[joint] for joint in leg)
            raise BadValueError(
                f"robot {description.name}: the {side} leg has {len(leg)} joints "
                f"({names}); a walking leg needs six"
            )
    legs = {*left, *right}
    return Biped(
        leg=_leg_geometry(description, left),
        left_leg=left,
        right_leg=right,
        left_arm=_arm(description, legs, side=1),
        right_arm=_arm(description, legs, side=-1),
        joint_range_rad=description.joint_range_rad,
        max_speed_rad_s=description.no_load_speed_rad_s,
        foot_sensor_xy_m=np.vstack([foot.sensors_m for foot in description.feet]),
    )


def _chain(description: Description, joint: int) -> tuple[int, ...]:
    """Joints from the root to this one."""
    chain: list[int] = []
    while joint >= 0:
        chain.insert(0, joint)
        joint = description.links[joint].parent
    return tuple(chain)


def _arm(description: Description, legs: set[int], side: int) -> tuple[int, int] | None:
    """Shoulder pitch and roll on one side (1 left, -1 right), if there is an arm."""
    for i, joint in enumerate(description.links):
        if joint.parent < 0 and i not in legs and joint.origin_m[1] * side > 0:
            for k, after in enumerate(description.links):
                if after.parent == i:
                    return i, k
    return None


def _leg_geometry(description: Description, leg: tuple[int, ...]) -> LegGeometry:
    yaw, roll, pitch, knee, ankle_pitch, ankle_roll = (
        description.links[joint] for joint in leg
    )
    for joint in (roll, pitch, ankle_roll):
        if np.abs(joint.origin_m).max() > 1e-9:
            raise BadValueError(
                f"robot {description.name}: the axis of {joint.name} does not meet "
                "that of the joint above it, as the leg's inverse kinematics needs"
            )
    hip_x, hip_y, hip_z = yaw.origin_m.tolist()
    axis_x, axis_y, axis_z = yaw.axis.tolist()
    return LegGeometry(
        hip_m=(hip_x, hip_y, hip_z),
        yaw_axis=(axis_x, axis_y, axis_z),
        thigh_m=math.hypot(*knee.origin_m),
        tibia_m=math.hypot(*ankle_pitch.origin_m),
        ankle_height_m=-description.feet[0].sole_height_m,
    )
