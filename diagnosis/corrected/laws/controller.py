"""What a servo's firmware does with its error, beside stiffness and damping."""

from collections.abc import Mapping

import mujoco
import numpy as np

from diagnosis.corrected.laws.step import Joint, Law, Step


class Controller(Law):
    """A servo with an integral term, a dead band, or a derivative of its error.

    With the error e of its target c, 0 below the dead band, the servo's torque is
    kp (e + integral_1_s int e dt) + kd (rate_share dc/dt - v). The integral's part is
    at most the torque limit, and begins such that the servo holds the joint against
    gravity, inertia, springs and friction. For its rate the target is smoothed by
    `lag_s`. (Astrom and Hagglund 2006, "Advanced PID control", chapter 3.)
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        integral_1_s: float = 0.0,
        dead_band_rad: float = 0.0,
        rate_share: float = 0.0,
        lag_s: float = 1e-9,
    ) -> None:
        """Add to a joint's servo; by default it gets nothing."""
        self.joint, self.integral_1_s = joints[joint], integral_1_s
        self.dead_band_rad, self.rate_share = dead_band_rad, rate_share
        self.lag_s = lag_s
        self.dry_nm = float(model.dof_frictionloss[self.joint.dof])
        self.smooth: float | None = None
        self.summed = 0.0

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        joint, target = self.joint, step.targets[self.joint.name]
        angle, speed = step.data.qpos[joint.qpos], step.data.qvel[joint.dof]
        if joint.motor is not None:
            angle, speed = joint.motor
        error = target - angle
        acting = self._acting(error, error - speed * step.seconds) * error
        kp = max(joint.kp, 1e-9)  # no division by zero
        if self.smooth is None:
            self.smooth = target
            gathered = -np.expm1(-60.0 * self.integral_1_s)
            self.summed = float(gathered * (self._held_nm(step) / kp - acting))
        summed = self.summed + self.integral_1_s * step.seconds * acting
        self.summed = min(max(summed, -joint.limit / kp), joint.limit / kp)
        moved = -np.expm1(-step.seconds / self.lag_s) * (target - self.smooth)
        self.smooth += moved
        lead = self.rate_share * joint.kd / kp * moved / step.seconds
        step.targets[joint.name] = float(angle + acting + self.summed + lead)

    def _acting(self, error: float, after: float) -> float:
        """Share of the step in which the error, from first to last, is not in the band.

        The joint moves on at its speed.
        """
        low, high = min(error, after), max(error, after)
        if high - low <= 1e-12:  # at rest
            return float(abs(error) >= self.dead_band_rad)
        inside = min(high, self.dead_band_rad) - max(low, -self.dead_band_rad)
        return 1 - min(max(inside, 0.0) / (high - low), 1.0)

    def _held_nm(self, step: Step) -> float:
        """Torque [N m] with which the servo moves its joint steadily at the start."""
        joint, data = self.joint, step.data
        speed = float(data.qvel[joint.dof])
        needed = data.qfrc_bias[joint.dof] - data.qfrc_passive[joint.dof]
        needed += np.tanh(speed / 0.02) * self.dry_nm  # smooth at standstill
        needed -= data.qfrc_applied[joint.dof] + joint.constant
        damping = joint.kd + (joint.back_emf if joint.is_spring else 0.0)
        return float(needed + damping * speed)
