"""Elasticity and play (backlash) between a motor and its joint."""

from dataclasses import dataclass


@dataclass
class Transmission:
    """A motor that drives its joint through a spring and damper with play.

    The rotor's inertia is part of the link in the nominal models, so the motor itself
    is taken as massless: its torque and the spring's are equal at all times. The servo
    controls the motor's angle m by the law of `servos.servo_torque_nm`. With q the
    joint's angle and u the motor's torque, each implicit Euler step solves for m:
      u = clip(kp (command - m) - kd dm/dt, +-most) - back_emf dm/dt,
      u = stiffness dead_zone(m - q, play / 2) + damping (dm/dt - dq/dt in contact).

    Attributes:
      stiffness_nm_rad, damping_nm_s_rad: of the spring.
      gap_rad: total play.
      step_s: time step of the physics.
      encoder_at_motor: whether the encoder reads the motor's angle, not the joint's.
      motor_rad: the motor's angle; None before the first step.
    """

    stiffness_nm_rad: float
    damping_nm_s_rad: float
    gap_rad: float
    step_s: float
    encoder_at_motor: bool = False
    motor_rad: float | None = None

    def torque(
        self,
        angle_rad: float,
        speed_rad_s: float,
        command_rad: float,
        servo: tuple[float, float, float, float],
    ) -> float:
        """Torque [N m] on the joint for the next step; moves the motor by one step.

        The set-point `command_rad` is that of the motor's angle; `servo` holds kp [N
        m/rad], kd [N m s/rad], largest torque [N m] and back-EMF [N m s/rad].
        """
        kp, kd, most, back_emf = servo
        before = angle_rad if self.motor_rad is None else self.motor_rad
        free = (kp, kp * command_rad, kd + back_emf)
        motor = self._balance(before, angle_rad, speed_rad_s, free)
        rate = (motor - before) / self.step_s
        wanted = kp * (command_rad - motor) - kd * rate
        if abs(wanted) > most:
            held = most if wanted > 0 else -most
            motor = self._balance(before, angle_rad, speed_rad_s, (0.0, held, back_emf))
            rate = (motor - before) / self.step_s
        self.motor_rad = motor
        return self._spring(motor - angle_rad, rate - speed_rad_s)

    def _spring(self, twist_rad: float, rate_rad_s: float) -> float:
        half = self.gap_rad / 2
        if abs(twist_rad) < half:
            return 0.0
        beyond = twist_rad - half if twist_rad > 0 else twist_rad + half
        return self.stiffness_nm_rad * beyond + self.damping_nm_s_rad * rate_rad_s

    def _balance(
        self, before: float, q: float, v: float, motor: tuple[float, float, float]
    ) -> float:
        """Motor angle m [rad] at which the torques of motor and spring are equal.

        One step before it was `before`; the joint has the angle q and the speed v; the
        motor's (pull, drive, drag) give its torque drive - pull m - drag dm/dt.
        """
        pull, drive, drag = motor
        half, h = self.gap_rad / 2, self.step_s
        weight = pull + drag / h
        push = drive + drag / h * before
        if half > 0 and weight > 0 and abs(push / weight - q) < half:
            return push / weight
        side = half if push > weight * q else -half
        stiff, damp = self.stiffness_nm_rad, self.damping_nm_s_rad
        return (push + stiff * (q + side) + damp * (before / h + v)) / (
            weight + stiff + damp / h
        )
