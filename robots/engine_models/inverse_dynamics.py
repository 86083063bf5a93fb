"""The torques that a model's joints need for a motion, from the text of its file."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from groundwalk.arrays import FloatArray
from robots.engine_models.mjcf import quiet_mujoco


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """Inverse dynamics of a model, without contacts, limits and actuators.

    What judges a diagnosis takes this and not the diagnosis' own.

    Example:
      >>> needed = InverseDynamics.of_text(path.read_text())
      >>> needed.of(("hip", "knee"), angles, speeds, accelerations).shape
      (500, 2)
    """

    model: mujoco.MjModel

    @classmethod
    def of_text(cls, text: str) -> "InverseDynamics":
        """The inverse dynamics of an MJCF, or of a URDF without meshes, as text."""
        quiet_mujoco()
        spec = mujoco.MjSpec.from_string(text)
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        for actuator in list(spec.actuators):
            spec.delete(actuator)
        return cls(spec.compile())

    def of(
        self, joints: Sequence[str], q: FloatArray, v: FloatArray, a: FloatArray
    ) -> FloatArray:
        """(T, j) torques [N m; N] of j joints for a motion, dry friction included.

        q, v and a are (T, j) angles [rad; m], speeds and accelerations; other joints
        rest at 0.
        """
        model, data, found = self.model, mujoco.MjData(self.model), np.zeros_like(q)
        angles = [int(model.joint(joint).qposadr[0]) for joint in joints]
        dofs = [int(model.joint(joint).dofadr[0]) for joint in joints]
        for k in range(len(q)):
            data.qpos[angles], data.qvel[dofs], data.qacc[dofs] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            found[k] = data.qfrc_inverse[dofs]
        return np.asarray(found + model.dof_frictionloss[dofs] * np.sign(v))
