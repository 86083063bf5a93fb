"""Servos that leave their torque limit within a physics step."""

from collections.abc import Mapping

import mujoco

from diagnosis.corrected.laws.step import Joint, Law, Step


class Saturation(Law):
    """Saturates a servo only if it is still at its torque limit when the step ends.

    MuJoCo decides that as a step begins, and leaves out the damping kd of a servo that
    saturates. But a light joint may get so fast within the step that the damping takes
    the torque below the limit: only I / (I + step kd) of it is left, with I the joint's
    inertia. This is no physics that MuJoCo lacks; it makes a coarse step more exact.
    """

    def __init__(
        self, model: mujoco.MjModel, joints: Mapping[str, Joint], joint: str
    ) -> None:
        """Watch a joint's servo."""
        self.joint = joints[joint]

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        joint, model, data = self.joint, step.model, step.data
        error = step.targets[joint.name] - data.qpos[joint.qpos]
        wanted = abs(joint.kp * error - joint.kd * data.qvel[joint.dof])
        diagonal = model.M_rowadr[joint.dof] + model.M_rownnz[joint.dof] - 1
        inertia = data.M[diagonal] + step.seconds * model.dof_damping[joint.dof]
        held_from = joint.limit * (1 + step.seconds * joint.kd / inertia)
        limit = 1e9 if joint.limit < wanted < held_from else joint.limit
        bounds = joint.constant - limit, joint.constant + limit
        model.actuator_forcerange[joint.actuator] = bounds
