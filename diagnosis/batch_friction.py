"""Dry friction of the joints in a batch of simulations."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from diagnosis.columns import columns
from diagnosis.plant import Plant
from groundwalk.arrays import FloatArray

SOLIMP_FRICTION = (0.999, 0.9999, 0.001, 0.5, 2.0)
"""Dry friction must hold: with MuJoCo's own default a tenth of it is viscous."""


class BatchFriction:
    """MuJoCo's friction loss, by speed and load where a variant asks for that."""

    def __init__(
        self,
        batch: Any,
        plant: Plant,
        joints: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Set the friction torques that do not change.

        Args:
          batch: a `mujoco.batch.Batch`.
          plant: that it simulates.
          joints: `Joints`, rows as the batch has them.
          step_s: of the physics.
        """
        self._joints, self._dofs = joints, columns(plant.dofs)
        self.varies = bool(joints["stribeck_nm"].any() or joints["load_share"].any())
        """Whether `follow` has anything to do."""
        self._torque_nm = np.asarray(batch.expand("dof_frictionloss"))
        self._torque_nm[:, self._dofs] += joints["coulomb_nm"]
        self._least_nm = self._torque_nm[:, self._dofs].copy()
        np.asarray(batch.expand("dof_solimp"))[:] = SOLIMP_FRICTION
        np.asarray(batch.expand("dof_solref"))[:] = (2 * step_s, 1.0)

    def follow(self, velocity_rad_s: FloatArray, driven_nm: FloatArray) -> None:
        """Set the torques for (rows, j) speeds and torques that drive the joints."""
        joints = self._joints
        speed = velocity_rad_s / joints["stribeck_speed_rad_s"]
        more = joints["stribeck_nm"] * np.exp(-(speed**2))
        more = more + joints["load_share"] * np.abs(driven_nm)
        self._torque_nm[:, self._dofs] = self._least_nm + more
