"""Robots with physics (effects) that their nominal model lacks, in MuJoCo."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import UnknownNameError
from robots.engine_models.mjcf import quiet_mujoco
from terrain import Heightfield
from worlds.hidden.effects.placed import Hidden, surroundings
from worlds.hidden.engine import ORIGIN_POSE, BodySense, present
from worlds.hidden.plant import HiddenPlant
from worlds.sim.world import add_ground, touch_shares

if TYPE_CHECKING:
    import mujoco


def hidden_model(
    plant: HiddenPlant,
    effects: Sequence[Hidden],
    step_s: float,
    ground: Heightfield | None,
) -> "mujoco.MjModel":
    """The robot's model, with joints, bodies, gravity and soles as the effects say.

    Effects on servos and signals change nothing here; `ground` is None for a fixed
    base.
    """
    import mujoco

    quiet_mujoco()
    spec = plant.make_spec()
    spec.compiler.discardvisual = False
    # If speeds are read as those half a step later, semi-implicit Euler is a leapfrog:
    # second-order accurate for all that depends on positions.
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.timestep = step_s
    for effect in effects:
        if effect.kind.place in ("joint", "body"):
            effect.kind.change_part(_part(spec, plant, effect), effect.values)
    around = surroundings(effects)
    spec.option.gravity = around.gravity_m_s2()
    if ground is not None:
        add_ground(spec, ground)
    model = spec.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    soles = model.geom_contype == 1
    # Without a priority MuJoCo takes the larger coefficient of sole and ground.
    model.geom_priority[soles] = 1
    if around.friction is not None:
        model.geom_friction[soles, 0] = around.friction
    return model


def _part(spec: Any, plant: HiddenPlant, effect: Hidden) -> Any:
    """The `MjsJoint` or `MjsBody` of a `mujoco.MjSpec` that an effect changes."""
    if effect.kind.place == "joint":
        plant.joint(effect.place)
        return spec.joint(effect.place)
    body = spec.body(effect.place)
    if body is None:
        known = [other.name for other in spec.bodies if other.name != "world"]
        raise UnknownNameError("body", effect.place, known)
    return body


def _slice(addresses: Sequence[int]) -> Any:
    """Index of the addresses: a slice, which copies nothing, or else a list of them."""
    first, count = addresses[0], len(addresses)
    whole = list(addresses) == list(range(first, first + count))
    return slice(first, first + count) if whole else list(addresses)


class HiddenMujoco:
    """One robot driven by joint torques in MuJoCo; implements `HiddenEngine`."""

    def __init__(self, plant: HiddenPlant, model: "mujoco.MjModel") -> None:
        """Allocate MuJoCo's data; `model` is the robot with its hidden effects."""
        import mujoco

        self._mujoco, self._model = mujoco, model
        self._data = mujoco.MjData(model)
        self._floating, robot = plant.floating, plant.description
        self._shares = None if robot is None else touch_shares(robot)
        hinges = [model.joint(name) for name in plant.joints]
        self._qpos = _slice([int(hinge.qposadr[0]) for hinge in hinges])
        self._dofs = _slice([int(hinge.dofadr[0]) for hinge in hinges])
        self._before = self._data.qvel.copy()
        self._forget()

    @property
    def position_rad(self) -> FloatArray:
        """(j,) angles of the joints after the last step."""
        return np.asarray(self._data.qpos[self._qpos])

    @property
    def velocity_rad_s(self) -> FloatArray:
        """(j,) speeds of the joints after the last step."""
        return np.asarray(self._data.qvel[self._dofs])

    def _forget(self) -> None:
        self._watched, self._sensors = 0, np.zeros(self._model.nsensordata)

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest in a (j,) pose, a floating base at this height."""
        self._mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[self._qpos] = pose_rad
        if self._floating:
            self._data.qpos[2] = height_m
        self._mujoco.mj_forward(self._model, self._data)
        self._before = self._data.qvel.copy()
        self._forget()

    def step(self, torque_nm: FloatArray) -> None:
        """Take one physics step under (j,) joint torques and the pushes set before."""
        model, data = self._model, self._data
        data.qfrc_applied[self._dofs] = torque_nm
        self._mujoco.mj_step1(model, data)
        if not self._floating:
            self._turn()
        self._mujoco.mj_step2(model, data)
        data.xfrc_applied[:] = 0.0

    def _turn(self) -> None:
        """Take the forces that turn links from the present speeds, see `present`.

        Constraints keep the late speeds: they are stiff, and would be unstable.
        """
        model, data = self._model, self._data
        late = data.qvel.copy()
        data.qvel[:] = present(late, self._before)
        self._mujoco.mj_comVel(model, data)
        self._mujoco.mj_rne(model, data, 0, data.qfrc_bias)
        data.qvel[:] = self._before = late
        self._mujoco.mj_comVel(model, data)

    def links_nm(self) -> FloatArray:
        """(j,) torques [N m] of gravity and turning links, those of the last step."""
        return np.asarray(-self._data.qfrc_bias[self._dofs])

    def push(self, body: str, force_n: FloatArray) -> None:
        """Let a (3,) force act at a body's centre of mass over the next step."""
        self._data.xfrc_applied[self._model.body(body).id, :3] += force_n

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a body's centre of mass [m/s], world frame."""
        kind, number = self._mujoco.mjtObj.mjOBJ_BODY, self._model.body(body).id
        both = np.zeros(6)
        self._mujoco.mj_objectVelocity(self._model, self._data, kind, number, both, 0)
        return both[3:]

    def watch(self) -> None:
        """Add the sensors' values of this step to the sums that `sense` averages."""
        self._sensors += self._data.sensordata
        self._watched += 1

    def sense(self) -> BodySense:
        """Mean sensor readings over the steps watched since the last call."""
        gyroscope, accelerometer, feet = np.zeros(3), np.zeros(3), np.zeros(8)
        if self._shares is not None:
            mean = self._sensors / max(self._watched, 1)
            touch = len(self._shares)
            feet = mean[:touch] @ self._shares
            gyroscope, accelerometer = mean[touch : touch + 3], mean[touch + 3 :]
        self._forget()
        pose, velocity = ORIGIN_POSE, np.zeros(6)
        if self._floating:
            pose, velocity = self._data.qpos[:7].copy(), self._data.qvel[:6].copy()
        sense = BodySense.of_base(pose, velocity, accelerometer, feet)
        return sense._replace(gyroscope_rad_s=gyroscope)

    def close(self) -> None:
        """Nothing has to be freed."""
