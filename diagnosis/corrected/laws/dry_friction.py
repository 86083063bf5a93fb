"""Dry friction that depends on speed, or on the torque through the gear."""

from collections.abc import Mapping

import mujoco
import numpy as np

from diagnosis.corrected.laws.step import Joint, Law, Step


class DryFriction(Law):
    """Friction that is larger at rest (Stribeck), or grows with load, or both.

    Beyond the friction of corrected.xml it is extra_nm exp(-(speed / speed_rad_s)^2)
    + load_share |torque through the gear|. MuJoCo gets it as `dof_frictionloss` before
    each step, so that it can hold the joint at rest.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        extra_nm: float = 0.0,
        speed_rad_s: float = 1.0,
        load_share: float = 0.0,
    ) -> None:
        """Add friction to a joint; by default it has none beyond corrected.xml's."""
        self.joint, self.load_share = joints[joint], load_share
        self.extra_nm, self.speed_rad_s = extra_nm, speed_rad_s
        self.least_nm = float(model.dof_frictionloss[self.joint.dof])

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        joint = self.joint
        speed = step.data.qvel[joint.dof]
        torque = step.data.actuator_force[joint.actuator] - joint.constant
        if not joint.is_spring:  # what drives a spring has passed the back-EMF
            torque -= joint.back_emf * speed
            torque += step.torques.get(joint.name, 0.0)
        slow = self.extra_nm * np.exp(-((speed / self.speed_rad_s) ** 2))
        loaded = self.load_share * abs(torque)
        step.model.dof_frictionloss[joint.dof] = self.least_nm + slow + loaded
