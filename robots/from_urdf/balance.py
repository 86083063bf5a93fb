"""Computes where ankles must be so that a crouched robot's weight is over its soles."""

import math
from collections.abc import Mapping

from robots.description import Foot
from robots.from_urdf.posed_tree import PosedTree

SOLE_PART, HIP_PART, HIPS_AHEAD_M = 0.43, 0.927, 0.010
"""Posture of the NAO in the gait Walk2014 of the team rUNSWift: place of the centre of
mass over the sole, as a share of the distance from heel to toe; height of the hips, as
a share of that with straight legs; distance of the hips ahead of the ankles [m]."""


def crouch_rad(thigh_m: float, tibia_m: float, hip_m: float) -> tuple[float, float]:
    """Hip pitch and knee angle [rad] of a crouched leg with its ankle below its hip.

    Args:
      thigh_m: length from hip to knee [m].
      tibia_m: length from knee to ankle [m].
      hip_m: height of the hip above the ankle [m].
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
    the NAO.

    Args:
      posed: the robot.
      crouch: angles [rad] of the legs' joints that put the ankles below the hips.
      foot: the left foot.
      scale: ratio of the robot's leg length to the NAO's.
    """
    crouched = posed.in_pose(crouch)
    ankle_m = crouched.origin_m(posed.moving[foot.joint])
    heel_m, toe_m = foot.outline_m[:, 0].min(), foot.outline_m[:, 0].max()
    weight_m = crouched.hanging("").com_m[0] - ankle_m[0]
    wanted_m = heel_m + SOLE_PART * (toe_m - heel_m)
    return float(weight_m - wanted_m + HIPS_AHEAD_M * scale)
