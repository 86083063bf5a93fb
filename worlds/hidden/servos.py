"""Servos of robots with hidden physics, and gears with play or elasticity."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from groundwalk.arrays import FloatArray
from worlds.hidden.plant import HiddenPlant

LAG = 0.1
"""Lag of a target's rate as a share of kd / kp: controllers have a half to a twentieth
(Astrom and Hagglund 2006, "Advanced PID control", chapter 3)."""


Gains = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Gains (j,) of servos: kp [N m/rad], kd [N m s/rad], back-EMF [N m s/rad] and largest
torque [N m]."""


def servo_torque_nm(
    gains: Gains,
    error_rad: FloatArray,
    speed_rad_s: FloatArray,
) -> FloatArray:
    """Joint torques (..., j) [N m] of servos: clip(kp e - kd v, +-max) - back_emf v.

    From the gains (j,) kp [N m/rad], kd [N m s/rad], back-EMF [N m s/rad] and largest
    torque [N m]; errors e (..., j), set-point minus position; and joint speeds v.
    """
    kp, kd, back_emf, most = gains
    torque = kp * error_rad - kd * speed_rad_s
    held = np.minimum(np.maximum(torque, -most), most)
    return np.asarray(held - back_emf * speed_rad_s)


REFERENCE_SPEED_RAD_S = 5.0
"""No-load speed of a motor of which none is known."""

LARGE_ERROR_RAD = 0.1
"""Error at which a servo without a torque limit counts as fully loaded."""

PLANNED = 20
"""Parts of a step in which a set-point with a limited acceleration is planned."""


class Servos:
    """Gains, limits and faults of a robot's servos, and the set-points they follow.

    Hidden effects change the arrays, each (j,) in the plant's order, before the first
    step.

    Attributes:
      kp_nm_rad, kd_nm_s_rad, back_emf_nm_s_rad, max_torque_nm: see `servo_torque_nm`.
      max_speed_rad_s: highest speed of a set-point that follows its command.
      max_acceleration_rad_s2: its largest acceleration, if not infinite.
      fade_1_s: share of kp that is lost in each second of the recording.
      offset_rad: constant encoder error, measured minus true angle.
      late_s: time by which a joint's reading is older than the others'; the servo's own
        reading is not.
      integral_1_s: integral gain as a multiple of kp, see `controlled`.
      dead_band_rad: error below which the servo gives no torque, see `controlled`.
      target_rate_share: share of the target's rate that damping takes from the joint's
        speed, see `controlled`.
      ripples: (joint, amplitude, per turn, phase) of periodic encoder errors, amplitude
        sin(per turn q + phase) [rad] at joint angle q, which the servo acts on.
      leaks: (to, from, share) for crosstalk between the commands of two joints.
      sag_share: share of the supply's voltage that is lost at full load of all.
    """

    def __init__(self, plant: HiddenPlant, step_s: float) -> None:
        """Begin with the nominal robot's servos; `step_s` is the physics step."""
        j = len(plant.joints)
        self.kp_nm_rad = plant.kp_nm_rad.copy()
        self.kd_nm_s_rad = plant.kd_nm_s_rad.copy()
        self.back_emf_nm_s_rad = plant.back_emf_nm_s_rad.copy()
        self.max_torque_nm = plant.max_torque_nm.copy()
        self.max_speed_rad_s = np.full(j, np.inf)
        self.max_acceleration_rad_s2 = np.full(j, np.inf)
        self.fade_1_s = np.zeros(j)
        self.offset_rad = np.zeros(j)
        self.late_s = np.zeros(j)
        self.integral_1_s = np.zeros(j)
        self.dead_band_rad = np.zeros(j)
        self.target_rate_share = np.zeros(j)
        self.ripples: list[tuple[int, float, float, float]] = []
        self.leaks: list[tuple[int, int, float]] = []
        self.sag_share = 0.0
        self._load_1_nm = _load_1_nm(plant)
        self._step_s = step_s
        self._target: FloatArray | None = None
        self._target_rad_s = np.zeros(j)
        self._summed_rad = np.zeros(j)
        self._lagging: FloatArray | None = None

    @cached_property
    def _fades(self) -> bool:
        return bool(self.fade_1_s.any())

    @cached_property
    def _controls(self) -> bool:
        return bool(self.integral_1_s.any() or self.dead_band_rad.any())

    @cached_property
    def _leads(self) -> bool:
        return bool(self.target_rate_share.any())

    @cached_property
    def _slews(self) -> bool:
        limits = self.max_speed_rad_s, self.max_acceleration_rad_s2
        return bool(np.isfinite(limits).any())

    @cached_property
    def _gentle(self) -> list[int]:
        """Columns of the joints whose set-points have a limited acceleration."""
        return [
            int(j) for j in np.flatnonzero(np.isfinite(self.max_acceleration_rad_s2))
        ]

    @cached_property
    def remember(self) -> bool:
        """Whether torques depend on earlier set-points, not on the present one only."""
        return self._controls or self._slews or self._leads

    def gains(self, time_s: float) -> Gains:
        """kp, kd, back-EMF and largest torque, each (j,), at a time of the recording.

        Units are those of `servo_torque_nm`; only kp changes with time, where it fades.
        """
        kp = self.kp_nm_rad
        if self._fades:
            kp = kp * np.maximum(1.0 - self.fade_1_s * max(time_s, 0.0), 0.0)
        return kp, self.kd_nm_s_rad, self.back_emf_nm_s_rad, self.max_torque_nm

    def voltage(self, torque_nm: FloatArray) -> float:
        """Share of the supply's voltage that is left under (j,) motor torques [N m]."""
        load = float(np.abs(torque_nm) @ self._load_1_nm)
        return max(1.0 - self.sag_share * load, 1e-3)

    def set_point(self, command_rad: FloatArray) -> FloatArray:
        """(j,) true joint angles [rad] that servos with these (j,) commands aim at."""
        target = command_rad
        if self.leaks:
            target = target.copy()
            for joint, source, share in self.leaks:
                target[joint] += share * command_rad[source]
        if self._slews:
            target = self._slewed(target)
        return target - self.offset_rad

    def controlled(self, target: FloatArray, position_rad: FloatArray) -> FloatArray:
        """(j,) set-points at which a stiffness alone acts as the whole controller does.

        With error e = target - position, both (j,) [rad], the controller's torque is
        kp (e + integral_1_s int e dt), the integral's part at most the servo's largest
        torque; it is 0 where the sum in brackets is below the dead band. What damping
        takes of the target's rate is added, see `_lead`. The position
        is the true one, from which that with an encoder's ripple follows.
        """
        if self.ripples:  # reading too much acts as a target that is too low
            target = target + (position_rad - self.rippled(position_rad))
        lead = self._lead(target) if self._leads else 0.0
        if not self._controls:
            return target + lead
        error = target - position_rad
        most = self.max_torque_nm / np.maximum(self.kp_nm_rad, 1e-9)
        more = self._summed_rad + self.integral_1_s * error * self._step_s
        self._summed_rad = np.clip(more, -most, most)
        error = error + self._summed_rad
        inside = np.abs(error) < self.dead_band_rad
        return np.asarray(position_rad + np.where(inside, 0.0, error) + lead)

    def _lead(self, target: FloatArray) -> FloatArray:
        """(j,) angles [rad] by which set-points lead (j,) targets, by their rates.

        The damping's torque is kd (share dc/dt - speed), c being the target behind a
        first-order lag of a tenth of kd / kp. The lag is solved for the step's end.
        """
        if self._lagging is None:
            self._lagging = target
        ahead_s = self.kd_nm_s_rad / np.maximum(self.kp_nm_rad, 1e-9)
        weight = self._step_s / (LAG * ahead_s + self._step_s)
        change = weight * (target - self._lagging)
        self._lagging = self._lagging + change
        return self.target_rate_share * ahead_s * change / self._step_s

    def rippled(self, angle_rad: FloatArray) -> FloatArray:
        """(j,) angles [rad] with the encoders' periodic errors added."""
        if not self.ripples:
            return angle_rad
        read = angle_rad.copy()
        for joint, amplitude, per_turn, phase in self.ripples:
            read[joint] += amplitude * math.sin(per_turn * angle_rad[joint] + phase)
        return read

    def _slewed(self, target: FloatArray) -> FloatArray:
        """(j,) set-points that follow (j,) targets at limited speed, from the first."""
        if self._target is None:
            self._target = target
        most, now = self.max_speed_rad_s * self._step_s, self._target
        change = target - now
        self._target = now + np.clip(change, -most, most)
        # At its speed limit a set-point moves all through the step. One below the limit
        # is a target, which is the same from the step's start on.
        middle = (now + self._target) / 2
        found = np.where(np.abs(change) > most, middle, self._target)
        for j in self._gentle:
            at, speed = float(now[j]), float(self._target_rad_s[j])
            for _ in range(PLANNED):
                at, speed = self._planned(j, at, speed, float(target[j]))
            self._target[j], self._target_rad_s[j] = at, speed
            found[j] = (now[j] + at) / 2
        return found

    def _planned(
        self, j: int, at: float, speed: float, target: float
    ) -> tuple[float, float]:
        """A set-point and its speed a small part of a step later, on a trapezoid.

        It brakes as soon as, going on for one more part, it could no longer stop at its
        target; it rests there once both are within a part's reach.
        """
        part_s, most = self._step_s / PLANNED, float(self.max_acceleration_rad_s2[j])
        far, more = target - at, most * part_s
        if abs(far) <= more * part_s and abs(speed) <= more:
            return target, 0.0
        towards = math.copysign(1.0, far)
        faster = min(towards * speed + more, float(self.max_speed_rad_s[j]))
        after = abs(far) - (towards * speed + faster) / 2 * part_s
        brakes = faster > 0 and faster**2 / (2 * most) > after
        then = towards * (towards * speed - more if brakes else faster)
        return at + (speed + then) / 2 * part_s, then


def _load_1_nm(plant: HiddenPlant) -> FloatArray:
    """(j,) share of the supply's full load that each N m of a motor's torque takes.

    A motor of torque t and no-load speed w takes a current in proportion to |t| w.
    """
    emf, most = plant.back_emf_nm_s_rad, plant.max_torque_nm
    limited = np.isfinite(most)
    full = np.where(limited, most, LARGE_ERROR_RAD * plant.kp_nm_rad)
    known = limited & (emf > 0)
    speed = np.where(known, full / np.where(known, emf, 1.0), REFERENCE_SPEED_RAD_S)
    return np.asarray(speed / (full @ speed))


@dataclass
class Transmission:
    """A motor that drives its joint through a spring and damper with play.

    The rotor's inertia is part of the link in the nominal models, so the motor itself
    is taken as massless: its torque and the spring's are equal at all times. The servo
    controls the motor's angle m by the law of `servos.servo_torque_nm`. With q the
    joint's angle and u the motor's torque, each step solves for m, with dm/dt by the
    second-order backward difference:
      u = clip(kp (command - m) - kd dm/dt, +-most) - back_emf dm/dt,
      u = stiffness dead_zone(m - q, play / 2) + damping (dm/dt - dq/dt in contact).
    The total play is `gap_rad`. The encoder reads the motor's angle, which is
    None before the first step, or else the joint's.
    """

    stiffness_nm_rad: float
    damping_nm_s_rad: float
    gap_rad: float
    step_s: float
    encoder_at_motor: bool = False
    motor_rad: float | None = None
    before_rad: float | None = None

    @property
    def next_rad(self) -> float | None:
        """The motor's angle one step later if it turns on as it did in the last one."""
        if self.motor_rad is None or self.before_rad is None:
            return self.motor_rad
        return 2 * self.motor_rad - self.before_rad

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
        last = angle_rad if self.motor_rad is None else self.motor_rad
        earlier = last if self.before_rad is None else self.before_rad
        before = (4 * last - earlier) / 3  # dm/dt = (m - before) / (2/3 step)
        free = (kp, kp * command_rad, kd + back_emf)
        motor = self._balance(before, angle_rad, speed_rad_s, free)
        rate = (motor - before) / self._lasted_s
        wanted = kp * (command_rad - motor) - kd * rate
        if abs(wanted) > most:
            held = most if wanted > 0 else -most
            motor = self._balance(before, angle_rad, speed_rad_s, (0.0, held, back_emf))
            rate = (motor - before) / self._lasted_s
        self.motor_rad, self.before_rad = motor, last
        return self._spring(motor - angle_rad, rate - speed_rad_s)

    @property
    def _lasted_s(self) -> float:
        """Time [s] of the backward difference, see `torque`."""
        return 2 * self.step_s / 3

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

        It changes from `before` in `_lasted_s`; the joint has the angle q and the speed
        v; the motor's (pull, drive, drag) give its torque drive - pull m - drag dm/dt.
        """
        pull, drive, drag = motor
        half, h = self.gap_rad / 2, self._lasted_s
        weight = pull + drag / h
        push = drive + drag / h * before
        if half > 0 and weight > 0 and abs(push / weight - q) < half:
            return push / weight
        side = half if push > weight * q else -half
        stiff, damp = self.stiffness_nm_rad, self.damping_nm_s_rad
        return (push + stiff * (q + side) + damp * (before / h + v)) / (
            weight + stiff + damp / h
        )
