"""Where a robot's ankles must be for its weight to be over its soles."""

import math
from collections.abc import Mapping

from robots.description import Foot
from robots.from_urdf.posed_tree import PosedTree

SOLE_PART, HIP_PART, HIPS_AHEAD_M = 0.43, 0.927, 0.010
"""Walk2014's gait on the NAO: where over the sole its centre of mass is, as a part
of the way from heel to toe; the height of its hips, as a part of that with straight
legs; and the way from ankles to hips."""


def crouch_rad(thigh_m: float, tibia_m: float, hip_m: float) -> tuple[float, float]:
    """Hip pitch and knee of a leg with level sole, by the law of cosines.

    Args:
      thigh_m: hip to knee.
      tibia_m: knee to ankle.
      hip_m: the hip's height above the ankle.
    """
    bend = (hip_m**2 - thigh_m**2 - tibia_m**2) / (2 * thigh_m * tibia_m)
    knee = math.acos(min(max(bend, -1.0), 1.0))
    behind = math.atan2(tibia_m * math.sin(knee), thigh_m + tibia_m * math.cos(knee))
    return -behind, knee


def ankles_ahead_m(
    posed: PosedTree, crouch: Mapping[str, float], foot: Foot, scale: float
) -> float:
    """How far ahead of the hips the ankles are when a gait asks for no offset.

    So far that with Walk2014's offset the weight is over the same part of the sole as
    on the NAO.

    Args:
      posed: the robot.
      crouch: angles of the legs' joints, the ankles below the hips.
      foot: the left foot.
      scale: the robot's length in units of the NAO's.
    """
    crouched = posed.in_pose(crouch)
    ankle_m = crouched.origin_m(posed.moving[foot.joint])
    heel_m, toe_m = foot.outline_m[:, 0].min(), foot.outline_m[:, 0].max()
    weight_m = crouched.hanging("").com_m[0] - ankle_m[0]
    wanted_m = heel_m + SOLE_PART * (toe_m - heel_m)
    return float(weight_m - wanted_m + HIPS_AHEAD_M * scale)
