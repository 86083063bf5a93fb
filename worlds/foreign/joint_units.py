"""Units of a LeRobot data set's joints, which its files do not tell."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from groundwalk.arrays import FloatArray
from groundwalk.errors import ForeignFileError, UnknownNameError
from worlds.foreign.calibration import MotorCalibration, read_calibration

PERCENT, PERCENT_0_100 = "percent", "percent_0_100"
UNITS = ("deg", "rad", PERCENT, PERCENT_0_100)
GRIPPER = "gripper"
"""The joint that LeRobot's arms always give in percent from 0 to 100."""


@dataclass(frozen=True)
class JointScale:
    """Turns a joint's numbers into radians: factor * (number - zero)."""

    factor: float
    zero: float = 0.0

    def radians(self, values: FloatArray) -> FloatArray:
        """Angles [rad] of numbers, of any shape."""
        return self.factor * (values - self.zero)


def joint_scales(
    where: str,
    joints: Sequence[str],
    units: Sequence[str],
    calibration: Path | None = None,
    without: Sequence[str] = (),
) -> dict[str, JointScale]:
    """Scales by joint of those that are not left out.

    The angle 0 of percentages is the middle of a joint's range, as it is for LeRobot's
    own degrees.

    Args:
      where: the data set, for errors.
      joints: all joints of the data set.
      units: the unit of all joints, and `joint=unit` of single ones.
      calibration: LeRobot's file with the joints' ranges.
      without: joints that are left out.

    Raises:
      ForeignFileError: a unit is missing or is surely wrong, or the range of a joint in
        percent is unknown.
      UnknownNameError: a unit or a joint is unknown.
    """
    of_all, of_one = _chosen(joints, units)
    for joint in without:
        if joint not in joints:
            raise UnknownNameError("joint", joint, joints)
    ranges = read_calibration(calibration) if calibration is not None else None
    scales = {}
    for joint in joints:
        if joint in without:
            continue
        unit = of_one.get(joint, of_all)
        if not unit:
            raise ForeignFileError(
                f"{where}: the unit of {joint} is not in the files; give --unit deg, "
                f"--unit rad, or --unit {PERCENT} with --calibration"
            )
        if joint == GRIPPER and joint not in of_one and unit != "rad":
            raise ForeignFileError(
                f"{where}: LeRobot's arms give {GRIPPER} from 0 to 100 whatever the "
                f"other joints are in; give --unit {unit} {GRIPPER}={PERCENT_0_100} "
                f"with --calibration, {GRIPPER}={unit} if it is as the others, or "
                f"--without {GRIPPER}"
            )
        scales[joint] = _scale(where, joint, unit, ranges)
    return scales


def _chosen(joints: Sequence[str], units: Sequence[str]) -> tuple[str, dict[str, str]]:
    """The unit of all joints, "" if there is none, and the units of single ones."""
    of_all, of_one = "", {}
    for text in units:
        joint, equals, unit = text.rpartition("=")
        if unit not in UNITS:
            raise UnknownNameError("unit", unit, UNITS)
        if not equals:
            of_all = unit
        elif joint not in joints:
            raise UnknownNameError("joint", joint, joints)
        else:
            of_one[joint] = unit
    return of_all, of_one


def _scale(
    where: str, joint: str, unit: str, ranges: Mapping[str, MotorCalibration] | None
) -> JointScale:
    if unit in ("deg", "rad"):
        return JointScale(math.pi / 180.0 if unit == "deg" else 1.0)
    if ranges is None:
        raise ForeignFileError(
            f"{where}: {joint} in percent needs the joints' ranges: --calibration "
            "FILE, the JSON that LeRobot wrote when the arm was calibrated"
        )
    if joint not in ranges:
        raise UnknownNameError("joint of the calibration", joint, ranges)
    per_percent = ranges[joint].rad_per_percent
    if unit == PERCENT:
        return JointScale(per_percent)
    return JointScale(2.0 * per_percent, zero=50.0)  # 100 percent instead of 200
