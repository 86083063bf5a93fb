"""A robot's geometry for a walk engine: its legs, arms, joint ranges and sensors."""

import math
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from robots.scale import NAO_SIZE, Scale

LEG_JOINTS = 6
FOOT_SENSORS = 8


@dataclass(frozen=True, eq=False)
class LegChain:
    """One leg as a chain of joints from the hip to the foot; its axes need not meet.

    Frames are parallel to the torso's with all joints at zero. Roles are yaw, roll,
    pitch, knee, ankle pitch and ankle roll. Angles by role are positive about +z, +x
    and +y, and zero with the leg straight down and the sole level.

    Attributes:
      origins_m: (6, 3) each joint from the one above, the first from the torso.
      axes: (6, 3) unit vectors.
      order: (6,) where in the chain each role is.
      signs: (6,) by role: -1 where the joint turns the other way.
      zero_rad: (6,) angles by role with all joints at zero.
      foot_m: (3,) from the ankle, which is the ankle pitch joint, to the last joint.
    """

    origins_m: FloatArray
    axes: FloatArray
    order: IntArray
    signs: FloatArray
    zero_rad: FloatArray
    foot_m: FloatArray


@dataclass(frozen=True)
class LegGeometry:
    """The left leg as its inverse kinematics see it; the right one is its mirror image.

    Six hinges: yaw, roll (axis +x), pitch, knee, ankle pitch (axes +y) and ankle
    roll (axis +x), all axes given with the leg straight. The three at the hip meet
    in one point, the two at the ankle in another. Mirror image means that equal yaw,
    pitch, knee and ankle pitch angles, and opposite roll angles, mirror the pose.

    Attributes:
      hip_m: where the hip axes meet, in the torso frame (x forward, y left, z up).
      yaw_axis: unit vector of the first joint's axis; on NAO it leans by 45 degrees.
      thigh_m: hip to knee.
      tibia_m: knee to ankle.
      ankle_height_m: sole to ankle axis.
    """

    hip_m: tuple[float, float, float]
    yaw_axis: tuple[float, float, float]
    thigh_m: float
    tibia_m: float
    ankle_height_m: float

    def __post_init__(self) -> None:
        """Refuse lengths that are not positive and yaw axes that turn no foot."""
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
    """A robot as a walk engine sees it.

    Joint arrays are (n, joints); the columns below are those of such arrays.

    Attributes:
      leg: lengths and axes of the left leg.
      left_leg: columns of yaw, roll, pitch, knee, ankle pitch and ankle roll.
      right_leg: columns of the right leg's joints, in that order.
      left_arm: columns of shoulder pitch and, where it has one, of shoulder roll; None
        without arms.
      right_arm: columns of the right arm's joints, in that order.
      joint_range_rad: (joints, 2) lower and upper end.
      max_speed_rad_s: (joints,) speeds of the motors without load.
      foot_sensor_xy_m: (8, 2) force sensors: left foot front left, front right, rear
        left, rear right, then the right foot; each in its own foot's ankle frame.
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
        """Refuse shapes and columns that do not belong together."""
        shapes = {
            "joint_range_rad": (self.joints, 2),
            "max_speed_rad_s": (self.joints,),
            "foot_sensor_xy_m": (FOOT_SENSORS, 2),
        }
        for name, shape in shapes.items():
            given = np.shape(getattr(self, name))
            if given != shape:
                raise BadValueError(
                    f"biped {name} has shape {given}; it must be {shape}"
                )
        for name in ("left_leg", "right_leg"):
            if len(getattr(self, name)) != LEG_JOINTS:
                raise BadValueError(f"biped {name} must name {LEG_JOINTS} columns")
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
        """Number of joints, that is of columns of a joint array."""
        return len(self.joint_range_rad)
