"""A torque that repeats with the angle of a joint."""

from collections.abc import Mapping

import mujoco
import numpy as np

from diagnosis.corrected.laws.step import Joint, Law, Step


class Ripple(Law):
    """A torque A sin(n q + phase) at a joint, with n waves in a turn.

    q is the joint's true angle, which is that of corrected.xml less the `offset_rad` of
    its encoder.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        torque_nm: float,
        per_turn: float,
        phase_rad: float,
        offset_rad: float = 0.0,
    ) -> None:
        """Add a ripple to a joint's torque."""
        self.joint, self.torque_nm = joints[joint], torque_nm
        self.per_turn, self.phase_rad = per_turn, phase_rad
        self.offset_rad = offset_rad

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        angle = step.data.qpos[self.joint.qpos] - self.offset_rad
        wave = np.sin(self.per_turn * angle + self.phase_rad)
        step.data.qfrc_applied[self.joint.dof] += self.torque_nm * wave
