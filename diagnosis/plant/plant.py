"""The plant: the nominal robot model that a diagnosis simulates."""

import copy
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import mujoco
import numpy as np

from diagnosis.plant.servo import Servo
from groundwalk.arrays import FloatArray
from worlds.recordings.load import Load

Base = Literal["fixed", "floating"]
"""How a robot's base is held: welded to the world, or free to move."""
ROOT = "root"
"""Name of a floating base's free joint."""
_SLIDING = (("kg m^2", "kg"), ("N m", "N"), ("rad", "m"))
"""Parts of units at turning joints, and their counterparts at sliding joints."""


@dataclass(frozen=True)
class ModelOptions:
    """MuJoCo options of a model file that a diagnosis replaces by its own.

    The integrator is a number in `mjtIntegrator`, flags are bits of `mjtDisableBit`.
    """

    timestep_s: float
    integrator: int
    disableflags: int


@dataclass(frozen=True, eq=False)
class Plant:
    """A nominal robot model whose joints are driven by servos.

    Attributes:
      spec: MuJoCo specification with one affine actuator for each driven joint, named
        as the joint; its control is a position target. A floating base has the free
        joint `root`.
      joints: hinges and slides that recordings have, in the model's order; all other
        joints are held still.
      servo: servos of these joints, for recordings that state no gains.
      feet: names of the bodies that touch the ground, left before right.
      options: MuJoCo options of the model's file; None for a file without, as a URDF.
      used_nm: (j,) largest torques measured at the joints; None if not compared.
      creeps: whether dry friction is as soft as the model's own solver parameters make
        it, so that joints creep; otherwise it stops a joint within a step.
      loads: known loads that the robot carries in recordings, see `bearing`.

    Example:
      >>> load_plant("nao", base="floating").joints
    """

    name: str
    spec: mujoco.MjSpec
    joints: tuple[str, ...]
    servo: Servo
    base: Base = "fixed"
    feet: tuple[str, ...] = ()
    options: ModelOptions | None = None
    used_nm: FloatArray | None = None
    creeps: bool = False
    loads: tuple[Mapping[str, Load], ...] = ()

    def without_ranges(self, joints: Collection[str]) -> "Plant":
        """A copy of the robot model in which these joints have no end stops."""
        if not joints:
            return self
        spec = self.spec.copy()
        for name in joints:
            spec.joint(name).limited = mujoco.mjtLimited.mjLIMITED_FALSE.value
        return replace(self, spec=spec)

    def bearing(self, loads: Sequence[Mapping[str, Load]]) -> "Plant":
        """The robot model for recordings with these loads, by the body's name.

        MuJoCo's compiler makes some bodies simple: their mass matrix has no room for
        what a load beside the centre of mass adds. So they must not be simple.
        """
        carried = list[Mapping[str, Load]]()
        carried += (one for one in loads if one and one not in carried)
        if not carried:
            return self
        spec = self.spec.copy()
        for name in set().union(*carried):
            spec.body(name).simple = False
        return replace(self, spec=spec, loads=tuple(carried))

    @cached_property
    def model(self) -> mujoco.MjModel:
        """The compiled model; do not change it."""
        return self.spec.compile()

    @cached_property
    def dofs(self) -> list[int]:
        """Index of each joint in MuJoCo's velocity vector."""
        return [int(self.model.joint(name).dofadr[0]) for name in self.joints]

    @cached_property
    def qpos(self) -> list[int]:
        """Index of each joint in MuJoCo's position vector."""
        return [int(self.model.joint(name).qposadr[0]) for name in self.joints]

    @cached_property
    def actuators(self) -> list[int]:
        """Index of each joint's actuator in MuJoCo's control vector."""
        return [int(self.model.actuator(name).id) for name in self.joints]

    @cached_property
    def slides(self) -> frozenset[str]:
        """Names of the joints that slide instead of turning."""
        kinds = {name: int(self.model.joint(name).type[0]) for name in self.joints}
        slide = int(mujoco.mjtJoint.mjJNT_SLIDE)
        return frozenset(name for name, kind in kinds.items() if kind == slide)

    def unit(self, unit: str, place: str) -> str:
        """The unit of a quantity at a place: "N/m" for "N m/rad" at a sliding joint."""
        if place in self.slides:
            for turning, sliding in _SLIDING:
                unit = unit.replace(turning, sliding)
        return unit

    @cached_property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies that have mass and move."""
        model = self.model
        return tuple(
            model.body(i).name
            for i in range(1, model.nbody)
            if model.body_mass[i] > 0 and model.body_weldid[i] > 0
        )

    def neighbours(self, body: str) -> frozenset[str]:
        """Names of a body's ancestors and descendants in the kinematic tree."""
        model = self.model
        own = int(model.body(body).id)
        return frozenset(
            model.body(i).name
            for i in range(1, model.nbody)
            if _carries(model, own, i) or _carries(model, i, own)
        )

    def at_rest(self, still: Collection[str]) -> frozenset[str]:
        """Names of the bodies that only the `still` joints, or none, could move."""
        if self.base == "floating":
            return frozenset()
        moved = [
            int(self.model.joint(name).bodyid[0])
            for name in self.joints
            if name not in still
        ]
        return frozenset(
            name
            for name in self.bodies
            for body in [int(self.model.body(name).id)]
            if not any(one == body or _carries(self.model, one, body) for one in moved)
        )


def _carries(model: mujoco.MjModel, body: int, other: int) -> bool:
    """Whether a body is an ancestor of another one in the kinematic tree."""
    while other > 0:
        other = int(model.body_parentid[other])
        if other == body:
            return True
    return False


def inverse_dynamics(
    plant: Plant,
    model: mujoco.MjModel,
    position_rad: FloatArray,
    velocity_rad_s: FloatArray,
    acceleration_rad_s2: FloatArray,
) -> FloatArray:
    """(R, j) torques [N m] that R rows of motion (R, j) of a fixed-base robot need.

    `model` is the plant's compiled model, or a copy of it with other numbers. MuJoCo's
    constraints, such as equalities between joints, are left out: they would turn sensor
    noise into large torques.
    """
    motion = position_rad, velocity_rad_s, acceleration_rad_s2
    return _inverse(plant, model, motion, "qfrc_inverse")


def links_torque_nm(
    plant: Plant,
    model: mujoco.MjModel,
    position_rad: FloatArray,
    velocity_rad_s: FloatArray,
) -> FloatArray:
    """(R, j) torques [N m] that gravity and the links' speeds put on the joints.

    They act along the joint: a link that hangs to the side pulls itself down. The robot
    has a fixed base; (R, j) positions and velocities are its motion, `model` is that of
    `inverse_dynamics`.
    """
    motion = position_rad, velocity_rad_s, np.zeros_like(velocity_rad_s)
    return -_inverse(plant, model, motion, "qfrc_bias")


def _inverse(
    plant: Plant,
    model: mujoco.MjModel,
    motion: tuple[FloatArray, FloatArray, FloatArray],
    result: str,
) -> FloatArray:
    """(R, j) values of a field of MuJoCo's data after inverse dynamics of a motion.

    The motion is (R, j) positions, velocities and accelerations of the joints.
    """
    position_rad, velocity_rad_s, acceleration_rad_s2 = motion
    model = copy.copy(model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(model)
    qpos = np.tile(data.qpos, (len(position_rad), 1))
    qvel, qacc, torque = (np.zeros((len(position_rad), model.nv)) for _ in range(3))
    qpos[:, plant.qpos] = position_rad
    qvel[:, plant.dofs], qacc[:, plant.dofs] = velocity_rad_s, acceleration_rad_s2
    # views of MuJoCo's own memory: looking them up takes longer than the computation
    views = data.qpos, data.qvel, data.qacc, getattr(data, result)
    for row in range(len(position_rad)):
        views[0][:], views[1][:], views[2][:] = qpos[row], qvel[row], qacc[row]
        mujoco.mj_inverse(model, data)
        torque[row] = views[3]
    return torque[:, plant.dofs]
