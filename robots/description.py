"""A robot as data: links, joints, motors, feet and sensors.

The MuJoCo and the PyBullet model are both made from this description. Frames: x
forward, y left, z up; with all joints at zero every joint's frame is parallel to the
root link's.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, UnknownNameError
from robots.rigid_body import Inertial
from robots.scale import NAO_SIZE, Scale

SENSORS_PER_FOOT = ("front_left", "front_right", "rear_left", "rear_right")
SHAPE_COLOURS = ("shell", "dark", "accent")


@dataclass(frozen=True)
class Capsule:
    """A visual capsule or sphere of a link; it has no collisions.

    The axis is in the joint's frame, its ends equal for a sphere. The colour is
    "shell", "dark" or "accent", which differs from robot to robot when several are
    shown.
    """

    start_m: tuple[float, float, float]
    end_m: tuple[float, float, float]
    radius_m: float
    colour: str = "shell"

    def __post_init__(self) -> None:
        """Refuse unknown colours."""
        if self.colour not in SHAPE_COLOURS:
            raise UnknownNameError("colour of a shape", self.colour, SHAPE_COLOURS)


@dataclass(frozen=True)
class VisualMesh:
    """A mesh file that shows a part of a link; it has no collisions.

    The file is STL, OBJ or COLLADA. Its frame's origin and unit quaternion w, x, y, z
    are in the joint's frame; `scale` holds factors along the mesh's x, y and z axes.
    """

    path: Path
    position_m: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    scale: tuple[float, float, float]


@dataclass(frozen=True)
class Motor:
    """A geared position servo with a torque-speed line.

    Its torque is `kp * (command - position) - kd * velocity`, clipped to the range from
    `stall * (-1 - velocity / no_load)` to `stall * (1 - velocity / no_load)`. If the
    motor board sets the duty cycle in proportion to the position error, the only
    damping is the motor's back-EMF: kd = stall / no_load. Stall torque is at full
    voltage, no-load speed, too; kd includes the back-EMF, the rotor inertia the squared
    gear ratio.
    """

    stall_torque_nm: float
    no_load_speed_rad_s: float
    kp_nm_rad: float
    kd_nm_s_rad: float
    rotor_kg_m2: float

    def __post_init__(self) -> None:
        """Refuse values that are negative or not finite."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise BadValueError(f"motor {name} is {value}; it must not be negative")

    @property
    def back_emf_nm_s_rad(self) -> float:
        """Damping by the back-EMF [N m s/rad]: stall torque over no-load speed."""
        return self.stall_torque_nm / self.no_load_speed_rad_s

    def drive_nm(self, error_rad: FloatArray, velocity_rad_s: FloatArray) -> FloatArray:
        """Drive voltage as the stall torque (n,) it would give [N m], before its limit.

        From (n,) commands minus positions [rad], and velocities of the joint [rad/s].
        """
        damping = self.kd_nm_s_rad - self.back_emf_nm_s_rad
        return np.asarray(self.kp_nm_rad * error_rad - damping * velocity_rad_s)

    def shared(self, joints: int) -> "Motor":
        """Divide this motor among a number of coupled joints: the share of each."""
        return Motor(
            self.stall_torque_nm / joints,
            self.no_load_speed_rad_s,
            self.kp_nm_rad / joints,
            self.kd_nm_s_rad / joints,
            self.rotor_kg_m2 / joints,
        )


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body, with all bodies that are fixed to it merged in.

    The inertial is in the frame of the link's joint, without rotors. Shapes (capsules
    and spheres) are drawn unless there are mesh files.
    """

    name: str
    inertial: Inertial
    shapes: tuple[Capsule, ...]
    meshes: tuple[VisualMesh, ...] = ()


@dataclass(frozen=True, eq=False)
class Joint:
    """A hinge with a motor, and the link that it moves.

    Attributes:
      name: as in commands and recordings.
      parent: index of the joint whose link carries this one, -1 for the root.
      origin_m: (3,) position in the frame of the parent joint.
      axis: (3,) unit vector of the joint's axis.
      range_rad: lower and upper end of the joint's range.
      motor: for a coupled pair, half of the shared motor in each joint.
      link: the body that the joint moves.
      slides: whether it slides along its axis, its position in m, instead of turning
        about it, as only in models that are shown (`worlds.scenes.mechanism`).
    """

    name: str
    parent: int
    origin_m: FloatArray
    axis: FloatArray
    range_rad: tuple[float, float]
    motor: Motor
    link: Link
    slides: bool = False

    @property
    def moved_inertial(self) -> Inertial:
        """Inertial of the joint's link with the motor's rotor inertia lumped in.

        The MuJoCo and the PyBullet model both use it.
        """
        return self.link.inertial.with_rotor(self.axis, self.motor.rotor_kg_m2)


@dataclass(frozen=True, eq=False)
class Foot:
    """A foot: its sole and its force sensors.

    The link of joint number `joint` is the foot; the sole is at height z in its frame,
    which is negative. The outline holds x and y of the sole's corners (points, 2),
    which is convex, the sensors those of four sensors (4, 2): front left, front right,
    rear left, rear right.
    """

    joint: int
    sole_height_m: float
    outline_m: FloatArray
    sensors_m: FloatArray


@dataclass(frozen=True)
class Imu:
    """Positions (x, y, z) [m] of gyroscope and accelerometer in the torso frame."""

    gyroscope_m: tuple[float, float, float]
    accelerometer_m: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Description:
    """A robot as data, from which its MuJoCo model and its URDF are generated.

    Attributes:
      root: the floating link; its frame is the torso frame.
      links: the joints, each with its link, in the order of columns of joint arrays.
      coupled: pairs of joint indices that one motor holds at the same angle.
      feet: left and right foot; none for a robot that is only shown, such as an arm.
      scale: size relative to the NAO.
      legs: columns of the left and the right leg's yaw, roll, pitch, knee, ankle pitch
        and ankle roll; None if they follow from the joints' axes.
      hanging_rad: left and right shoulder pitch at which the arms hang down.
      ankles_ahead_m: distance of the ankles ahead of the hips when the gait parameter
        `com_offset` is zero.

    Example:
      >>> robots.get("nao").joints[:2]
      ('LHipYawPitch', 'LHipRoll')
    """

    name: str
    root: Link
    links: tuple[Joint, ...]
    coupled: tuple[tuple[int, int], ...]
    feet: tuple[Foot, ...]
    imu: Imu
    scale: Scale = NAO_SIZE
    legs: tuple[tuple[int, ...], tuple[int, ...]] | None = None
    hanging_rad: tuple[float, float] = (math.pi / 2, math.pi / 2)
    ankles_ahead_m: float = 0.0

    @cached_property
    def joints(self) -> tuple[str, ...]:
        """Joint names in the order of the columns of every (n, joints) array."""
        return tuple(joint.name for joint in self.links)

    @cached_property
    def joint_range_rad(self) -> FloatArray:
        """(joints, 2) lower and upper end of each joint's range [rad]."""
        return np.array([joint.range_rad for joint in self.links])

    @cached_property
    def no_load_speed_rad_s(self) -> FloatArray:
        """(joints,) speed of each joint's motor without load [rad/s]."""
        return np.array([joint.motor.no_load_speed_rad_s for joint in self.links])

    def chain(self, joint: int) -> tuple[int, ...]:
        """Indices of the joints from the root to a joint, that joint included."""
        above = self.links[joint].parent
        return (*(self.chain(above) if above >= 0 else ()), joint)

    @property
    def mass_kg(self) -> float:
        """Mass of the whole robot [kg]."""
        return self.root.inertial.mass_kg + sum(
            joint.link.inertial.mass_kg for joint in self.links
        )
