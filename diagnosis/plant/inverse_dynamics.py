"""Inverse dynamics: the joint torques that a motion of the robot model needs."""

import copy
from typing import TYPE_CHECKING

import numpy as np

from diagnosis.plant.plant import Plant
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    import mujoco


def inverse_dynamics(
    plant: Plant,
    model: "mujoco.MjModel",
    position_rad: FloatArray,
    velocity_rad_s: FloatArray,
    acceleration_rad_s2: FloatArray,
) -> FloatArray:
    """Compute the joint torques that motions of a fixed-base robot need.

    MuJoCo's constraints, such as equalities between joints, are left out: they would
    turn sensor noise into large torques.

    Args:
      plant: the robot model; it gives the joints' indices in MuJoCo's vectors.
      model: the compiled model to use: the plant's, or a copy with other numbers.
      position_rad: (R, j) positions of the j joints in R rows.
      velocity_rad_s: (R, j) joint velocities.
      acceleration_rad_s2: (R, j) joint accelerations.

    Returns:
      (R, j) torques [N m].
    """
    import mujoco

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
