"""MuJoCo as the physics engine of a robot with hidden physics."""

from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.engine import BodySense
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
        self._floating = plant.floating
        self._q = data.qpos[ROOT_QPOS if plant.floating else 0 :]
        self._v = data.qvel[ROOT_QVEL if plant.floating else 0 :]
        self._applied = data.qfrc_applied[ROOT_QVEL if plant.floating else 0 :]
        self._shares = None
        if plant.description is not None:
            self._shares = touch_shares(plant.description)
        self._pushed = False
        self.position_rad, self.velocity_rad_s = self._q, self._v
        self._forget()

    def _forget(self) -> None:
        self._watched = 0
        self._sensors = np.zeros(self._model.nsensordata)

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest in a (j,) pose, a floating base at this height."""
        self._mujoco.mj_resetData(self._model, self._data)
        self._q[:] = pose_rad
        if self._floating:
            self._data.qpos[2] = height_m
        self._mujoco.mj_forward(self._model, self._data)
        self._forget()

    def step(self, torque_nm: FloatArray) -> None:
        """Take one physics step under (j,) joint torques and the pushes set before."""
        self._applied[:] = torque_nm
        self._mujoco.mj_step(self._model, self._data)
        if self._pushed:
            self._data.xfrc_applied[:] = 0.0
            self._pushed = False

    def push(self, body: str, force_n: FloatArray) -> None:
        """Let a (3,) force act at a body's centre of mass over the next step."""
        self._data.xfrc_applied[self._model.body(body).id, :3] += force_n
        self._pushed = True

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a body's centre of mass [m/s], world frame."""
        kind = self._mujoco.mjtObj.mjOBJ_BODY
        both = np.zeros(6)
        number = self._model.body(body).id
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
            feet = np.maximum(mean[:touch] @ self._shares, 0.0)
            gyroscope, accelerometer = mean[touch : touch + 3], mean[touch + 3 :]
        self._forget()
        data, free = self._data, self._floating
        upright = np.array([1.0, 0.0, 0.0, 0.0])
        return BodySense(
            gyroscope_rad_s=gyroscope,
            accelerometer_m_s2=accelerometer,
            foot_force_n=feet,
            position_m=data.qpos[:3].copy() if free else np.zeros(3),
            orientation=data.qpos[3:7].copy() if free else upright,
            linear_m_s=data.qvel[:3].copy() if free else np.zeros(3),
            angular_rad_s=data.qvel[3:6].copy() if free else np.zeros(3),
        )

    def close(self) -> None:
        """Nothing has to be freed."""
