"""A spring between motor and link (an elastic joint)."""

from collections import deque
from collections.abc import Mapping

import mujoco

from diagnosis.corrected.laws.step import Joint, Law, Step


class ElasticDrive(Law):
    """A motor that drives its link through a spring K with damping D.

    A motor with inertia J, angle m and speed w, at a link with angle q, follows
      J w' = servo(target, m) - back-EMF w - K (m - q) - D (w - q').
    It is stepped here, solved for the step's end, since J may be small and K large;
    MuJoCo has the link, and its actuator becomes the spring. The encoder sees the
    motor, `delay_s` late. (Spong 1987, "Modeling and control of elastic joint robots".)
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        joint: str,
        stiffness_nm_rad: float,
        damping_nm_s_rad: float,
        rotor_kg_m2: float,
        delay_s: float = 0.0,
    ) -> None:
        """Make a joint's actuator the spring, and take the rotor out of its link."""
        self.joint, self.K, self.D = joints[joint], stiffness_nm_rad, damping_nm_s_rad
        self.J, self.delay_s = rotor_kg_m2, delay_s
        self.angle: float | None = None
        self.speed = self.speed_before = self.link_before = 0.0
        self.seconds = float(model.opt.timestep)
        self.seen: deque[tuple[float, float]] = deque()
        row, dof = self.joint.actuator, self.joint.dof
        unlimited = 1e9  # N m, as if there were no limit
        model.actuator_gainprm[row, 0] = self.K
        model.actuator_biasprm[row, 1] = -self.K
        model.actuator_biasprm[row, 2] = -self.D - self.seconds * self.K
        model.actuator_forcelimited[row] = 1
        model.actuator_forcerange[row] = -unlimited, unlimited
        model.dof_damping[dof] -= self.joint.back_emf
        model.dof_armature[dof] -= self.J
        self.joint.is_spring = True

    def before_step(self, step: Step) -> None:
        """Act on the step; see `Law`."""
        joint, h = self.joint, step.seconds
        q, v = float(step.data.qpos[joint.qpos]), float(step.data.qvel[joint.dof])
        if self.angle is None:
            self.angle, self.speed = q, v
            self.speed_before = self.link_before = v
            self._note()
        link = 2 * v - self.link_before  # at the step's end
        target = step.targets.get(joint.name, q)
        target += h * (2 * self.speed - self.speed_before)
        self.link_before, self.speed_before = v, self.speed
        push = step.torques.pop(joint.name, 0.0) + self.D * link
        push -= self.K * (self.angle - q - h * link)
        self.speed = self._speed(target - self.angle, self.J * self.speed + h * push, h)
        self.angle += h * self.speed
        self._note()
        step.targets[joint.name] = self.angle + self.D * self.speed / self.K

    def _speed(self, error: float, momentum: float, h: float) -> float:
        """Speed of the motor after a step, within the servo's torque limit."""
        kp, kd, limit = self.joint.kp, self.joint.kd, self.joint.limit
        mass = self.J + h * (self.joint.back_emf + self.D) + h * h * self.K
        free = (momentum + h * kp * error) / (mass + h * kd + h * h * kp)
        wanted = kp * (error - h * free) - kd * free
        held = min(max(wanted, -limit), limit)
        return free if wanted == held else (momentum + h * held) / mass

    def _note(self) -> None:
        """Keep the motor's angles and speeds for as long as the encoder is late."""
        assert self.angle is not None
        self.joint.motor = self.angle, self.speed
        self.seen.append((self.angle, self.speed))
        steps = int(self.delay_s / self.seconds) + 2
        while len(self.seen) < steps:
            self.seen.appendleft(self.seen[0])
        while len(self.seen) > steps:
            self.seen.popleft()

    def position(self, joint: str) -> tuple[float, float] | None:
        """The motor's angle and speed, by cubic interpolation between two steps."""
        if joint != self.joint.name or self.angle is None:
            return None
        h, t = self.seconds, 1 - (self.delay_s / self.seconds) % 1
        (q0, v0), (q1, v1) = self.seen[0], self.seen[1]
        rise, v0, v1 = q1 - q0, h * v0, h * v1
        bend = 3 * rise - 2 * v0 - v1 + t * (v0 + v1 - 2 * rise)
        return q0 + t * (v0 + t * bend), (v0 + t * (v1 - v0)) / h
