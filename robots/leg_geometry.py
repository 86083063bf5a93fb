"""Legs, by the roles of their joints; a biped as the walk engine needs it."""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from robots.scale import NAO_SIZE, Scale

ROLES = ("yaw", "roll", "pitch", "knee", "ankle_pitch", "ankle_roll")
KNEE, ANKLE = 3, 4
_X, _Y, _Z = range(3)
_CLEAR = 0.9


def roles(axes: FloatArray) -> tuple[int, ...]:
    """Indices of yaw, roll, pitch, knee, ankle pitch and ankle roll among a leg's axes.

    The unit vectors (6, 3) go from hip to foot; x is forward, y left, z up. The order
    of the three hip joints is the one in which yaw, roll and pitch axes are closest to
    z, x and y in sum; the NAO's yaw axis leans by 45 degrees. The order of ankle pitch
    and roll is found in the same way. The fourth joint is the knee; ValueError if its
    axis is not close to y.
    """
    if abs(axes[KNEE, _Y]) < _CLEAR:
        raise ValueError(f"the knee's axis is {np.round(axes[KNEE], 3)}, not y")
    hip = _closest(axes[:KNEE], (_Z, _X, _Y))
    ankle = _closest(axes[ANKLE:], (_Y, _X))
    return (*hip, KNEE, *(ANKLE + k for k in ankle))


def _closest(axes: FloatArray, wanted: tuple[int, ...]) -> tuple[int, ...]:
    """Order of axes (k, 3) in which they are closest, in sum, to k coordinate axes."""
    return max(
        itertools.permutations(range(len(axes))),
        key=lambda order: float(np.abs(axes[list(order), list(wanted)]).sum()),
    )


LEG_JOINTS = 6
FOOT_SENSORS = 8


@dataclass(frozen=True, eq=False)
class LegChain:
    """One leg as a chain of joints from the hip to the foot; its axes need not meet.

    Frames are parallel to the torso's with all joints at zero. The roles of the joints
    are yaw, roll, pitch, knee, ankle pitch and ankle roll. Angles by role are positive
    about +z (yaw), +x (rolls) and +y (pitches and knee), and zero if the leg points
    straight down and the sole is level.

    Attributes:
      origins_m: (6, 3) position of each joint relative to the one above it (or the
        torso).
      axes: (6, 3) unit vectors of the joints' axes.
      order: (6,) index in the chain of the joint of each role.
      signs: (6,) by role: -1 if the joint's angle counts the other way, else 1.
      zero_rad: (6,) angles by role with all joints at zero.
      foot_m: (3,) vector from the ankle pitch joint to the last joint.
    """

    origins_m: FloatArray
    axes: FloatArray
    order: IntArray
    signs: FloatArray
    zero_rad: FloatArray
    foot_m: FloatArray


@dataclass(frozen=True)
class LegGeometry:
    """Geometry of the left leg for closed inverse kinematics; the right leg mirrors it.

    Six hinges: yaw, roll (axis +x), pitch, knee, ankle pitch (axes +y) and ankle roll
    (axis +x), all axes given with the leg straight. The three at the hip meet in the
    point `hip_m` of the torso frame (x forward, y left, z up), the two at the ankle in
    another, at `ankle_height_m` above the sole; the knee divides thigh and tibia. The
    unit vector of the yaw axis leans by 45 degrees on the NAO. Mirror image means that
    equal yaw, pitch, knee and ankle pitch angles, and opposite roll angles, mirror the
    pose.

    Example:
      >>> robots.biped(robots.get("nao")).leg.thigh_m
      0.1
    """

    hip_m: tuple[float, float, float]
    yaw_axis: tuple[float, float, float]
    thigh_m: float
    tibia_m: float
    ankle_height_m: float

    def __post_init__(self) -> None:
        """Refuse lengths that are not positive and yaw axes without a vertical part."""
        for name in ("thigh_m", "tibia_m", "ankle_height_m"):
            length = getattr(self, name)
            if not (math.isfinite(length) and length > 0):
                raise BadValueError(f"leg {name} is {length}; it must be positive")
        if not all(map(math.isfinite, self.hip_m)):
            raise BadValueError(f"leg hip_m is {self.hip_m}; it must be finite")
        if not math.isclose(math.hypot(*self.yaw_axis), 1.0, abs_tol=1e-6):
            raise BadValueError(
                f"leg yaw_axis is {self.yaw_axis}; its length must be 1"
            )
        if abs(self.yaw_axis[2]) < 1e-3:
            raise BadValueError(
                f"leg yaw_axis is {self.yaw_axis}; a joint about it must turn the foot"
            )


@dataclass(frozen=True, eq=False)
class Biped:
    """A robot on two legs as the walk engine needs it.

    "Columns" below are those of arrays (n, joints) of commands or joint angles.

    Attributes:
      leg: lengths and axes of the left leg.
      left_leg, right_leg: columns of yaw, roll, pitch, knee, ankle pitch and ankle
        roll.
      left_arm, right_arm: columns of shoulder pitch and, if it exists, shoulder roll;
        None without arms.
      joint_range_rad: (joints, 2) lower and upper end of each joint's range.
      max_speed_rad_s: (joints,) speeds of the motors without load.
      foot_sensor_xy_m: (8, 2) force sensors: left foot front left, front right, rear
        left, rear right, then the right foot; each in its own foot's ankle frame.
      chains: the left and right leg as chains if their axes do not meet, else None.
      hanging_rad: left and right shoulder pitch at which the arms hang down.
      arm_signs: left and right: -1 if the shoulder pitch axis points right, else 1.
      scale: size relative to the NAO.
      ankles_ahead_m: distance of the ankles ahead of the hips when the gait parameter
        `com_offset` is zero.

    Example:
      >>> robots.biped(robots.get("nao")).left_arm
    """

    leg: LegGeometry
    left_leg: tuple[int, ...]
    right_leg: tuple[int, ...]
    left_arm: tuple[int, ...] | None
    right_arm: tuple[int, ...] | None
    joint_range_rad: FloatArray
    max_speed_rad_s: FloatArray
    foot_sensor_xy_m: FloatArray
    chains: tuple[LegChain, LegChain] | None = None
    hanging_rad: tuple[float, float] = (math.pi / 2, math.pi / 2)
    arm_signs: tuple[float, float] = (1.0, 1.0)
    scale: Scale = NAO_SIZE
    ankles_ahead_m: float = 0.0

    def __post_init__(self) -> None:
        """Refuse repeated columns, empty ranges and motors without speed."""
        arms = (self.left_arm or ()) + (self.right_arm or ())
        columns = self.left_leg + self.right_leg + arms
        known = set(range(self.joints))
        if len(set(columns)) != len(columns) or not set(columns) <= known:
            raise BadValueError(
                f"biped columns {columns} must differ and be 0 to {self.joints - 1}"
            )
        if not (self.joint_range_rad[:, 0] < self.joint_range_rad[:, 1]).all():
            raise BadValueError("biped joint_range_rad must rise from lower to upper")
        if not (self.max_speed_rad_s > 0).all():
            raise BadValueError("biped max_speed_rad_s must be positive")

    @property
    def joints(self) -> int:
        """Number of joints, which is the number of columns of joint arrays."""
        return len(self.joint_range_rad)
