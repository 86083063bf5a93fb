"""Computes joint torques by inverse dynamics of the robot model."""

import copy

import mujoco
import numpy as np

from diagnosis.plant.plant import Plant
from groundwalk.arrays import FloatArray


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
    model = copy.copy(model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(model)
    torque = np.zeros_like(position_rad)
    for row in range(len(position_rad)):
        data.qpos[plant.qpos] = position_rad[row]
        data.qvel[plant.dofs] = velocity_rad_s[row]
        data.qacc[plant.dofs] = acceleration_rad_s2[row]
        mujoco.mj_inverse(model, data)
        torque[row] = data.qfrc_inverse[plant.dofs]
    return torque
