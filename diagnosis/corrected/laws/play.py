"""Play in a gear (backlash)."""

from collections.abc import Mapping

import mujoco

from diagnosis.corrected.laws.step import Joint, Law, Step


class Play(Law):
    """A gear with a gap of `gap_rad`, within which no torque passes.

    The motor has no inertia here (it is part of the joint's), so that within the gap
    its angle m follows m' = kp (target - m) / (kd + back-EMF). At an edge of the gap,
    half of it from the joint's angle, it pushes the joint. The encoder sits at the
    joint. (Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model.)
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        gap_rad: float,
    ) -> None:
        """Give a joint's gear play; its motor starts as near its target as it may."""
        self.joint, self.gap_rad = joints[joint], gap_rad
        self.motor: float | None = None

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        joint, target = self.joint, step.targets[self.joint.name]
        angle, speed = step.data.qpos[joint.qpos], step.data.qvel[joint.dof]
        low, high = angle - self.gap_rad / 2, angle + self.gap_rad / 2
        if self.motor is None:
            self.motor = min(max(target, low), high)
        before = self.motor
        free = before + self._way(target - before, step.seconds)
        self.motor = min(max(free, low), high)
        joint.motor = self.motor, (self.motor - before) / step.seconds
        if low < free < high:  # nothing touches: the servo must not brake the joint
            step.targets[joint.name] = angle
            servo_nm = min(max(joint.kd * speed, -joint.limit), joint.limit)
            braking_nm = servo_nm + joint.back_emf * speed
            step.data.qfrc_applied[joint.dof] += braking_nm
        else:
            step.targets[joint.name] = angle + target - self.motor

    def _way(self, error: float, seconds: float) -> float:
        """How far the free motor goes in a step, solved for its end."""
        joint, least = self.joint, 1e-9  # no division by zero
        drag = max(joint.kd + joint.back_emf, least) / seconds
        most = seconds * joint.limit / max(joint.back_emf, least)
        way = joint.kp * error / (joint.kp + drag)
        return float(min(max(way, -most), most))
