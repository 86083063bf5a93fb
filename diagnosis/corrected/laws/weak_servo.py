"""Servos that become weaker with time, or are off for some time."""

from collections.abc import Mapping

import mujoco

from diagnosis.corrected.laws.step import Joint, Law, Step


class WeakServo(Law):
    """A servo loses stiffness, or is off for some time, or both.

    Its stiffness falls by the share `fade_1_s` a second from time 0 on. From
    `off_start_s` to `off_end_s` the share `off_share` of its torque is lost. Times are
    the simulation's, 0 where the recordings began.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        fade_1_s: float = 0.0,
        off_share: float = 0.0,
        off_start_s: float = 0.0,
        off_end_s: float = 0.0,
    ) -> None:
        """Weaken a joint's servo; by default it stays as it is."""
        self.joint, self.fade_1_s = joints[joint], fade_1_s
        self.off_share, self.off_s = off_share, (off_start_s, off_end_s)
        self.full = self.joint.kp, self.joint.kd

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        now, joint = step.data.time, self.joint
        begin, end = max(now, self.off_s[0]), min(now + step.seconds, self.off_s[1])
        on = 1 - self.off_share * max(end - begin, 0.0) / step.seconds
        strong = on * joint.voltage
        joint.kp = self.full[0] * max(1 - self.fade_1_s * now, 0.0) * strong
        joint.kd = self.full[1] * strong
        if joint.name in step.torques:
            step.torques[joint.name] *= on
        if not joint.is_spring:
            gains, bias = step.model.actuator_gainprm, step.model.actuator_biasprm
            gains[joint.actuator, 0] = joint.kp
            bias[joint.actuator, 1:3] = -joint.kp, -joint.kd
