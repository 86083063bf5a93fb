"""What torques a motion takes, by a plant's own mechanics."""

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
    """(R, j) torques at the joints of a plant with a fixed base.

    Constraints are left out: where joints are tied, they would fight the noise.

    Args:
      plant: tells which rows are the joints'.
      model: the plant's, or one with other numbers.
      position_rad: (R, j).
      velocity_rad_s: (R, j).
      acceleration_rad_s2: (R, j).
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
