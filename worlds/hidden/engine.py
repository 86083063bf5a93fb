"""The interface of the physics engines that simulate robots with hidden physics."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.hidden.effects.placed import Hidden
from worlds.hidden.plant import HiddenPlant

ENGINES = ("bullet", "mujoco")
"""Names of the physics engines that can simulate robots with hidden physics."""
ORIGIN_POSE = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
"""Position [m] and quaternion w, x, y, z of a fixed base."""
WATCH_STEPS = 8
"""Number of physics steps over which sensed forces and accelerations are averaged: 2 to
4 ms, shorter than any tick and long enough for the noise of contacts to cancel."""


class BodySense(NamedTuple):
    """Readings of a robot's noiseless sensors, and the pose and velocity of its base.

    Vectors are (3,), zero where a robot lacks the sensor. Gyroscope, accelerometer and
    turning rate are in the base's frame; position and linear velocity in that of the
    ground or of a fixed base's mount, even if tilted, into which the quaternion w, x,
    y, z `orientation` turns. `foot_force_n` (8,) is that at four points of the left,
    then of the right sole.
    """

    gyroscope_rad_s: FloatArray
    accelerometer_m_s2: FloatArray
    foot_force_n: FloatArray
    position_m: FloatArray
    orientation: FloatArray
    linear_m_s: FloatArray
    angular_rad_s: FloatArray

    @classmethod
    def of_base(
        cls, pose: FloatArray, velocity: FloatArray, felt: FloatArray, feet: FloatArray
    ) -> "BodySense":
        """Readings at a base with this pose (7,) and velocity (6,), the fields' order.

        The gyroscope shows the turning rate; `felt` is the accelerometer's reading
        (3,), `feet` the forces on the soles (8,), of which negative ones count as 0.
        """
        rate, feet = velocity[3:], np.maximum(feet, 0.0)
        return cls(rate, felt, feet, pose[:3], pose[3:], velocity[:3], rate)


def present(late: FloatArray, before: FloatArray) -> FloatArray:
    """Speeds at a physics step's start, from those half a step ago and one before.

    Leapfrog integration has speeds half a step late. Forces that depend on them, such
    as centrifugal ones, are second-order accurate with these instead.
    """
    return 1.5 * late - 0.5 * before


class HiddenEngine(Protocol):
    """A physics engine with one robot, stepped under joint torques."""

    @property
    def position_rad(self) -> FloatArray:
        """(j,) angles of the joints after the last step."""

    @property
    def velocity_rad_s(self) -> FloatArray:
        """(j,) speeds of the joints after the last step."""

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest in a (j,) pose, a floating base upright at a height."""

    def step(self, torque_nm: FloatArray) -> None:
        """Take one physics step under (j,) joint torques and the pushes set before."""

    def push(self, body: str, force_n: FloatArray) -> None:
        """Let a (3,) force act at a body's centre of mass over the next step."""

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a body's centre of mass [m/s]."""

    def links_nm(self) -> FloatArray:
        """(j,) torques [N m] that gravity and turning links put on a fixed robot.

        They act along the joints, at present angles and speeds without accelerations.
        """

    def watch(self) -> None:
        """Add this step's sensor values to a mean, in the last few steps of a tick."""

    def sense(self) -> BodySense:
        """Mean sensor readings over the steps since the last call that were watched."""

    def close(self) -> None:
        """Free the engine's memory."""


def check_engine(name: str, effects: Sequence[Hidden], floating: bool) -> None:
    """Refuse effects that an engine, or a floating base, cannot have."""
    if name not in ENGINES:
        raise BadValueError(f"engine is {name!r}; it must be {' or '.join(ENGINES)}")
    for effect in effects:
        if name not in effect.kind.engines:
            only = " and ".join(effect.kind.engines)
            raise BadValueError(f"{effect.name} needs the engine {only}, not {name}")
        if effect.kind.fixed_base_only and floating:
            raise BadValueError(f"{effect.name} needs a fixed base, not a floating one")


def least_inertia_kg_m2(plant: HiddenPlant, pose_rad: FloatArray) -> FloatArray:
    """(j,) inertia [kg m^2] seen by a torque at each joint, all other joints free."""
    import mujoco

    model = plant.make_spec().compile()
    data = mujoco.MjData(model)
    data.qpos[7 if plant.floating else 0 :] = pose_rad
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return np.asarray(1.0 / np.diag(np.linalg.inv(mass))[-len(plant.joints) :])
