"""Simulates motors that drive their links through springs or gaps, in a batch."""

from collections.abc import Mapping

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray

LEAST_KP = 1e-9
"""Smallest stiffness [N m/rad] used as a divisor, to avoid division by zero."""

LEAST_DRAG = 1e-9
"""Smallest damping [N m s/rad] used as a divisor, to avoid division by zero; a motor
without stiffness and damping then does not move."""


class ElasticJoints:
    """Motors that drive their links through springs: arrays (rows, j).

    A motor with inertia J, angle m and speed w follows (Spong 1987)
      J w' = servo(command, m) - (kd + emf) w - K (m - q) - D (w - q'),
    with q the link's angle, stepped implicitly, since J may be small and K large.
    MuJoCo simulates the link, driven by an actuator that acts as the spring. `soft`
    says whether a joint has a spring; `stiffness` K is 1 where there is none.
    """

    def __init__(
        self,
        joints: Mapping[str, FloatArray],
        servo: Mapping[str, FloatArray],
        inertia: FloatArray,
    ) -> None:
        """Make motors that start at the angles of their links.

        `joints` are arrays of `Joints` by name, `servo` is `BatchServos.law`, and
        `inertia` (rows, j) that of the rotors [kg m^2].
        """
        self.soft = np.isfinite(joints["spring_nm_rad"])
        self.stiffness = np.where(self.soft, joints["spring_nm_rad"], 1.0)
        self.damping = joints["spring_damping_nm_s_rad"]
        self._servo, self._inertia = servo, inertia
        self._angle: FloatArray | None = None
        self._speed = np.zeros_like(self.stiffness)

    def drive(
        self,
        asked_rad: FloatArray,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        step_s: float,
        torque_nm: FloatArray | float = 0.0,
    ) -> FloatArray:
        """Step the motors once; (rows, j) targets for the actuators that are springs.

        The servo sees the motor's angle before the step, as MuJoCo's servos do. The
        spring sees the speeds of both ends after it; the link's is extrapolated from
        the last two steps. So a stiff spring has a rigid joint's integration error.
        Positions and velocities (rows, j) are those of the links; `torque_nm` is
        further torque on the motors.
        """
        h, link_before = step_s, velocity_rad_s.copy()
        if self._angle is None:
            self._angle = position_rad.copy()
            self._speed = self._speed_before = self._link_before = link_before
        link = 2 * velocity_rad_s - self._link_before
        wanted_rad = asked_rad + h * (2 * self._speed - self._speed_before)
        self._link_before, self._speed_before = link_before, self._speed
        push = torque_nm + self.damping * link
        push -= self.stiffness * (self._angle - position_rad - h * link)
        momentum = self._inertia * self._speed + h * push
        speed = self._stepped(wanted_rad, momentum, h)
        self._speed = np.where(self.soft, speed, velocity_rad_s)
        self._angle = np.where(self.soft, self._angle + h * speed, position_rad)
        target = self._angle + self.damping * self._speed / self.stiffness
        return np.where(self.soft, target, asked_rad)

    def _stepped(
        self, asked_rad: FloatArray, momentum: FloatArray, h: float
    ) -> FloatArray:
        """(rows, j) speeds of the motors after a step `h`, with torque limits."""
        servo = self._servo
        kp, kd, limit = servo["kp"], servo["kd"], servo["limit"]
        inner = servo["emf"] + self.damping
        mass = self._inertia + h * inner + h * h * self.stiffness
        assert self._angle is not None
        error = asked_rad - self._angle
        free = (momentum + h * kp * error) / (mass + h * kd + h * h * kp)
        wanted = kp * (error - h * free) - kd * free
        held = np.minimum(np.maximum(wanted, -limit), limit)
        bound = (momentum + h * held) / mass
        return np.asarray(np.where(np.abs(wanted) > limit, bound, free))

    def seen(self, position_rad: FloatArray) -> FloatArray:
        """(rows, j) angles [rad] that encoders measure: of motors at elastic joints."""
        if self._angle is None:
            return position_rad
        return np.where(self.soft, self._angle, position_rad)

    def seen_speed(self, velocity_rad_s: FloatArray) -> FloatArray:
        """(rows, j) speeds [rad/s] that encoders see: of motors at elastic joints."""
        if self._angle is None:
            return velocity_rad_s
        return np.where(self.soft, self._speed, velocity_rad_s)


class BatchGaps:
    """Motors that turn freely within their gaps until they touch the joint.

    A motor has no inertia here, since its inertia is part of the joint's. While it is
    free, its servo moves its angle m by m' = kp (command - m) / (kd + back-EMF), and no
    torque reaches the joint. It touches the joint at half the gap from its position,
    and goes further by the gear's compliance times the torque that passes.

    Source: Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model, with a motor whose damping outweighs its inertia.
    """

    def __init__(
        self,
        joints: Mapping[str, FloatArray],
        law: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Prepare gaps of (rows, j) `joints` with servos of a `law`, which may fade.

        Only joints with a gap are computed, as (g,) arrays.
        """
        self._at = np.nonzero(joints["gap_rad"])
        self._half = joints["gap_rad"][self._at] / 2
        self._yields = joints["compliance_rad_nm"][self._at]
        self._law, self._step_s = law, step_s
        self._motor_rad: FloatArray | None = None
        self._wound_rad = self._motor_rad_s = np.zeros_like(self._half)

    def begin(self) -> None:
        """Forget the motors' angles; they start as near their targets as gaps allow."""
        self._motor_rad = None

    def seen(
        self, position: FloatArray, velocity: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """(rows, j) angles [rad] that servos control, and their speeds [rad/s].

        Those of motors at joints with a gap, after the first step; else the joints'.
        """
        if self._motor_rad is None:
            return position, velocity
        angles, speeds = position.copy(), velocity.copy()
        angles[self._at], speeds[self._at] = self._motor_rad, self._motor_rad_s
        return angles, speeds

    def through(
        self, asked_rad: FloatArray, position: FloatArray, velocity: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Step the motors once; targets for rigid servos, and torques beside these.

        With the targets (rows, j) [rad] a servo without gap gives the torque that gets
        through the gap. The torques (rows, j) [N m] take its damping back where none
        does.
        """
        law = {name: values[self._at] for name, values in self._law.items()}
        asked, joint = asked_rad[self._at], position[self._at]
        low, high = joint - self._half, joint + self._half
        if self._motor_rad is None:
            self._motor_rad = np.minimum(np.maximum(asked, low), high)
            self._wound_rad = np.zeros_like(joint)
        drag = (law["kd"] + law["emf"]) / self._step_s
        free = self._motor_rad + self._moved(law, drag, asked - self._motor_rad)
        apart: BoolArray = (free > low) & (free < high)
        edge = np.minimum(np.maximum(free, low), high)
        driven = law["kp"] * (asked - edge) - drag * (edge - self._motor_rad)
        wound = np.where(apart, 0.0, self._wound(law, drag, driven))
        winding = drag * (wound - self._wound_rad) / np.maximum(law["kp"], LEAST_KP)
        self._motor_rad_s = (edge + wound - self._motor_rad) / self._step_s
        self._motor_rad, self._wound_rad = edge + wound, wound
        targets, free_nm = asked_rad.copy(), np.zeros_like(asked_rad)
        arrives = np.where(apart, 0.0, asked - self._motor_rad - winding)
        targets[self._at] = joint + arrives
        free_nm[self._at] = np.where(apart, _damping_nm(law, velocity[self._at]), 0.0)
        return targets, free_nm

    def _wound(
        self, law: Mapping[str, FloatArray], drag: FloatArray, driven: FloatArray
    ) -> FloatArray:
        """(g,) angles beyond the gap's edge of motors that push, after a step.

        They are the compliance times the torque, solved for implicitly; at the edge the
        torque would be `driven` [N m].
        """
        through = driven / (1 + self._yields * (law["kp"] + drag))
        held = np.minimum(np.maximum(through, -law["limit"]), law["limit"])
        return np.asarray(self._yields * held)

    def _moved(
        self, law: Mapping[str, FloatArray], drag: FloatArray, error_rad: FloatArray
    ) -> FloatArray:
        """(g,) ways of free motors in one implicit step, torque limited."""
        drag = np.maximum(drag, LEAST_DRAG / self._step_s)
        moved = law["kp"] * error_rad / (law["kp"] + drag)
        emf = np.maximum(law["emf"], LEAST_DRAG)
        most = self._step_s * law["limit"] / emf
        return np.asarray(np.minimum(np.maximum(moved, -most), most))


def _damping_nm(law: Mapping[str, FloatArray], velocity: FloatArray) -> FloatArray:
    """Damping torque [N m] of servos whose motors are free, at their joints' speeds."""
    servo_nm = np.maximum(law["kd"] * velocity, -law["limit"])
    return np.asarray(np.minimum(servo_nm, law["limit"]) + law["emf"] * velocity)
