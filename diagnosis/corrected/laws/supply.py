"""A supply of all servos that gives way under load."""

from collections.abc import Mapping

import mujoco

from diagnosis.corrected.laws.step import Joint, Law, Step


class SupplySag(Law):
    """Servos share a supply, whose voltage falls with the torques of their motors.

    For each N m of a motor's torque, as it was in the step before, the share
    `lost_1_nm` of the voltage is lost. Stiffness, damping and torque limit of all
    servos are in proportion to what is left, at least a thousandth; back-EMF is not.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        lost_1_nm: Mapping[str, float],
    ) -> None:
        """Let motors, by their joints' names, take voltage."""
        self.joints, self.lost_1_nm = list(joints.values()), lost_1_nm
        self.full = [(one.kp, one.kd, one.limit) for one in self.joints]

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        lost = sum(
            self.lost_1_nm.get(one.name, 0.0) * abs(self._driven_nm(step, one))
            for one in self.joints
        )
        voltage = max(1 - lost, 1e-3)
        model = step.model
        for one, (kp, kd, limit) in zip(self.joints, self.full, strict=True):
            one.voltage = voltage
            one.kp, one.kd, one.limit = kp * voltage, kd * voltage, limit * voltage
            if one.is_spring:
                continue
            model.actuator_gainprm[one.actuator, 0] = one.kp
            model.actuator_biasprm[one.actuator, 1:3] = -one.kp, -one.kd
            most = min(one.limit, 1e9)
            bounds = one.constant - most, one.constant + most
            model.actuator_forcerange[one.actuator] = bounds

    def _driven_nm(self, step: Step, joint: Joint) -> float:
        """Torque [N m] of a motor, or of the spring behind it, in the step before."""
        driven_nm = float(step.data.actuator_force[joint.actuator]) - joint.constant
        if joint.is_spring:
            return driven_nm
        return driven_nm - joint.back_emf * float(step.data.qvel[joint.dof])
