"""A robot as data: links, joints, motors, feet and sensors.

Both engines' models are made from this one description. Frames: x forward, y
left, z up; with all joints at zero every joint frame is parallel to the root's.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError, UnknownNameError
from robots.rigid_body import Inertial
from robots.scale import NAO_SIZE, Scale

SENSORS_PER_FOOT = ("front_left", "front_right", "rear_left", "rear_right")
SHAPE_COLOURS = ("shell", "dark", "accent")


@dataclass(frozen=True)
class Capsule:
    """A round shape of a link, to be looked at; it never touches anything.

    Attributes:
      start_m, end_m: ends of the axis in the joint's frame; equal for a sphere.
      radius_m: the radius.
      colour: one of SHAPE_COLOURS; "accent" is another colour for each robot in view.
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
    """A file that shows a part of a link; like a capsule it never touches anything.

    Attributes:
      path: STL, OBJ or COLLADA.
      position_m: of the mesh's frame in the joint's frame.
      orientation: unit quaternion w, x, y, z from the mesh's frame to the joint's.
      scale: factors of the mesh's own axes.
    """

    path: Path
    position_m: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    scale: tuple[float, float, float]


@dataclass(frozen=True)
class Motor:
    """A geared position servo with a torque-speed line.

    Its torque is `kp * (command - position) - kd * velocity`, held between
    `stall * (-1 - velocity / no_load)` and `stall * (1 - velocity / no_load)`.
    A board that sets the duty cycle in proportion to the position error has the
    motor's back-EMF as its damping: kd = stall / no_load.

    Attributes:
      stall_torque_nm, no_load_speed_rad_s: the ends of the torque-speed line.
      kp_nm_rad: stiffness.
      kd_nm_s_rad: damping, back-EMF included.
      rotor_kg_m2: rotor inertia behind the gear.
    """

    stall_torque_nm: float
    no_load_speed_rad_s: float
    kp_nm_rad: float
    kd_nm_s_rad: float
    rotor_kg_m2: float

    def __post_init__(self) -> None:
        """Refuse negative and infinite values."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise BadValueError(f"motor {name} is {value}; it must not be negative")

    @property
    def back_emf_nm_s_rad(self) -> float:
        """Slope of the torque-speed line [N m s/rad]."""
        return self.stall_torque_nm / self.no_load_speed_rad_s

    def drive_nm(self, error_rad: FloatArray, velocity_rad_s: FloatArray) -> FloatArray:
        """Stall torque (n,) that the drive asks for [N m]; the motor has a limited one.

        Args:
          error_rad: (n,) command less position.
          velocity_rad_s: (n,) of the joint.
        """
        damping = self.kd_nm_s_rad - self.back_emf_nm_s_rad
        return np.asarray(self.kp_nm_rad * error_rad - damping * velocity_rad_s)

    def shared(self, joints: int) -> "Motor":
        """The part of this motor that each of its coupled joints gets."""
        return Motor(
            self.stall_torque_nm / joints,
            self.no_load_speed_rad_s,
            self.kp_nm_rad / joints,
            self.kd_nm_s_rad / joints,
            self.rotor_kg_m2 / joints,
        )


@dataclass(frozen=True, eq=False)
class Link:
    """A rigid body, everything that is fixed to it merged in.

    Attributes:
      name: the link's name.
      inertial: in the frame of the link's joint, without any rotor.
      shapes: round shapes to draw.
      meshes: mesh files to draw in their place, where there are any.
    """

    name: str
    inertial: Inertial
    shapes: tuple[Capsule, ...]
    meshes: tuple[VisualMesh, ...] = ()


@dataclass(frozen=True, eq=False)
class Joint:
    """A hinge with a motor, and the link that it moves.

    Attributes:
      name: the joint's name, as in commands and recordings.
      parent: index of the joint whose link carries this one, -1 for the root.
      origin_m: (3,) in the frame of the parent link's joint.
      axis: (3,) unit vector.
      range_rad: lower and upper end.
      motor: the motor; for a coupled pair, half of the shared motor in each joint.
      link: the body that the joint moves.
      slides: whether it slides along its axis instead of turning about it. Only robot
        models that are shown have such joints (`worlds.scenes.mechanism`); positions
        are then in m.
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
        """The link with the motor's rotor lumped in, as both engines carry it."""
        return self.link.inertial.with_rotor(self.axis, self.motor.rotor_kg_m2)


@dataclass(frozen=True, eq=False)
class Foot:
    """A foot: its sole and its force sensors.

    Attributes:
      joint: index of the joint whose link is the foot.
      sole_height_m: of the sole in that joint's frame; negative.
      outline_m: (points, 2) corner points of the sole, x and y, convex.
      sensors_m: (4, 2) force sensors, x and y, in the order SENSORS_PER_FOOT.
    """

    joint: int
    sole_height_m: float
    outline_m: FloatArray
    sensors_m: FloatArray


@dataclass(frozen=True)
class Imu:
    """Where the root link carries its inertial sensors, in the root's frame."""

    gyroscope_m: tuple[float, float, float]
    accelerometer_m: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Description:
    """A robot with a floating root.

    Attributes:
      name: the robot's name.
      root: the floating link; its frame is the torso frame.
      links: one per joint, in the order of the columns of all arrays.
      coupled: pairs of joints that one motor holds at the same angle.
      feet: left and right; none if the robot is only to be shown, such as an arm.
      imu: the inertial sensors.
      scale: how much larger than the NAO it is.
      legs: columns of the left and the right leg's yaw, roll, pitch, knee, ankle
        pitch and ankle roll; None where the axes tell.
      hanging_rad: left and right shoulder pitch at which the arms hang down.
      ankles_ahead_m: way from hips to ankles when a gait asks for no offset.
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
        """(joints, 2) lower and upper end of each joint."""
        return np.array([joint.range_rad for joint in self.links])

    @cached_property
    def no_load_speed_rad_s(self) -> FloatArray:
        """(joints,) speed of each motor without load."""
        return np.array([joint.motor.no_load_speed_rad_s for joint in self.links])

    @cached_property
    def parents(self) -> IntArray:
        """(joints,) index of each joint's parent joint, -1 for the root."""
        return np.array([joint.parent for joint in self.links], np.intp)

    @property
    def mass_kg(self) -> float:
        """The whole robot's mass."""
        return self.root.inertial.mass_kg + sum(
            joint.link.inertial.mass_kg for joint in self.links
        )
