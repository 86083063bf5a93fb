"""MuJoCo as the physics engine of a robot with hidden physics."""

from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.engine import ORIGIN_POSE, BodySense
from worlds.hidden.plant import HiddenPlant
from worlds.sim.model import ROOT_QPOS, ROOT_QVEL, touch_shares

if TYPE_CHECKING:
    import mujoco


class HiddenMujoco:
    """One robot driven by joint torques in MuJoCo; implements `HiddenEngine`."""

    def __init__(self, plant: HiddenPlant, model: "mujoco.MjModel") -> None:
        """Allocate MuJoCo's data; `model` is the robot with its hidden effects."""
        import mujoco

        self._mujoco, self._model = mujoco, model
        self._data = data = mujoco.MjData(model)
        self._floating, robot = plant.floating, plant.description
        self._shares = None if robot is None else touch_shares(robot)
        self.position_rad = data.qpos[ROOT_QPOS if plant.floating else 0 :]
        self.velocity_rad_s = data.qvel[ROOT_QVEL if plant.floating else 0 :]
        self._applied = data.qfrc_applied[ROOT_QVEL if plant.floating else 0 :]
        self._forget()

    def _forget(self) -> None:
        self._watched, self._sensors = 0, np.zeros(self._model.nsensordata)

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest in a (j,) pose, a floating base at this height."""
        self._mujoco.mj_resetData(self._model, self._data)
        self.position_rad[:] = pose_rad
        if self._floating:
            self._data.qpos[2] = height_m
        self._mujoco.mj_forward(self._model, self._data)
        self._forget()

    def step(self, torque_nm: FloatArray) -> None:
        """Take one physics step under (j,) joint torques and the pushes set before."""
        self._applied[:] = torque_nm
        self._mujoco.mj_step(self._model, self._data)
        self._data.xfrc_applied[:] = 0.0

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
