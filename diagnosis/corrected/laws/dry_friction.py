"""Dry friction that depends on speed, angle, or the torque through the gear."""

from collections.abc import Mapping

import mujoco
import numpy as np

from diagnosis.corrected.laws.step import Joint, Law, Step


class DryFriction(Law):
    """Friction that is larger at rest (Stribeck), or changes with load or angle.

    Beyond the friction of corrected.xml it is, with v the speed, T the motor's torque
    less its back-EMF, and L the torque of gravity and the links' motion on the joint,
      |link_share L - load_share T| + exp(-|v / speed_rad_s|^exponent)
      (extra_nm + |extra_link_share L - extra_load_share T| + extra_square_1_nm P^2)
      + angle_nm (exp(angle_log_1_rad (q - angle_from_rad)) - 1).
    P is the smaller one of T and L where they are opposed, else 0; q is the joint's
    angle, and the exponent of it is kept within +-5. MuJoCo gets it as
    `dof_frictionloss` before each step, so that it can hold the joint at rest.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        extra_nm: float = 0.0,
        speed_rad_s: float = 1.0,
        exponent: float = 2.0,
        load_share: float = 0.0,
        link_share: float = 0.0,
        extra_load_share: float = 0.0,
        extra_link_share: float = 0.0,
        extra_square_1_nm: float = 0.0,
        angle_nm: float = 0.0,
        angle_log_1_rad: float = 0.0,
        angle_from_rad: float = 0.0,
    ) -> None:
        """Add friction to a joint; by default it has none beyond corrected.xml's."""
        self.joint = joints[joint]
        self.extra_nm, self.extra_square_1_nm = extra_nm, extra_square_1_nm
        self.speed_rad_s, self.exponent = speed_rad_s, exponent
        self.angle_nm, self.angle_from_rad = angle_nm, angle_from_rad
        self.angle_log_1_rad = angle_log_1_rad
        self.shares = link_share, load_share
        self.extra_shares = extra_link_share, extra_load_share
        self.least_nm = float(model.dof_frictionloss[self.joint.dof])

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        joint = self.joint
        speed = step.data.qvel[joint.dof]
        motor = step.data.actuator_force[joint.actuator] - joint.constant
        if not joint.is_spring:  # what drives a spring has passed the back-EMF
            motor -= joint.back_emf * speed
            motor += step.torques.get(joint.name, 0.0)
        links = -step.data.qfrc_bias[joint.dof]
        through = min(abs(motor), abs(links)) if motor * links < 0 else 0.0
        always, extra = (
            abs(of_links * links - of_motor * motor)
            for of_links, of_motor in (self.shares, self.extra_shares)
        )
        extra += self.extra_nm + self.extra_square_1_nm * through**2
        slow = np.exp(-(abs(speed / self.speed_rad_s) ** self.exponent))
        far_rad = step.data.qpos[joint.qpos] - self.angle_from_rad
        grown = min(max(self.angle_log_1_rad * far_rad, -5.0), 5.0)
        always += self.angle_nm * np.expm1(grown)
        step.model.dof_frictionloss[joint.dof] = self.least_nm + always + slow * extra
