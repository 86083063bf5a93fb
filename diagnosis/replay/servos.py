"""Servos of joints in a batch, as affine actuators of MuJoCo."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.columns import columns
from diagnosis.replay.transmission import LEAST_KP, ElasticJoints
from groundwalk.arrays import FloatArray

UNLIMITED_NM = 1e9
"""Torque limit [N m] that stands for no limit, since MuJoCo needs a finite number."""

LEAST_VOLTAGE = 1e-3
"""Share of a supply's voltage that is left at least: no servo loses all of its gains.
"""

JUMP = 0.3
"""A target that changes in one physics step by more than this share of the position
error at which the servo saturates counts as a jump."""

MOST_OF_STEP = 0.6
"""Share of a physics step that is most of it. Half would be the phase of many a jump,
as of each second one where a step takes two thirds of a tick."""

Ends = tuple[FloatArray, FloatArray]
"""Position targets (rows, j) [rad] as a physics step begins, and as it ends."""


class BatchServos:
    """Servos of all simulations in a batch, as affine actuators of MuJoCo.

    Arrays have a row for each simulation: one variant of the robot model in one run.

    Attributes:
      law: present gains and limits of the servos, arrays (rows, j): `kp` [N m/rad],
        `kd` [N m s/rad], `limit` [N m] and `emf`, the back-EMF [N m s/rad].
      varies: whether any servo becomes weaker with time or load, or is off for some
        time; if so, call `weaken` at every step.
      least_jump_rad: (rows, j) smallest change of a target [rad] that counts as a jump.
    """

    def __init__(
        self,
        batch: Any,
        plant: Plant,
        servos: Sequence[Servo],
        joints: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Give every simulation the servos of its run, changed as its variant says.

        `joints` are arrays of `Joints` by name with a row for each simulation in the
        batch, sorted by variant, then by run.
        """
        self._joints, self._actuators = joints, columns(plant.actuators)
        self._goes_off = bool(joints["off_share"].any())
        self._sags = bool(joints["sag_1_nm"].any())
        self.varies = self._goes_off or self._sags or bool(joints["fade_1_s"].any())
        self._step_s = step_s
        self._stiff = np.isinf(joints["spring_nm_rad"])
        self.law = servo_laws(servos, joints)
        self._full_kp = kp = self.law["kp"]
        self._full_kd, self._full_limit = self.law["kd"], self.law["limit"]
        reach = self.law["limit"] / np.maximum(kp, LEAST_KP)
        self.least_jump_rad = JUMP * reach
        self._gain = np.asarray(batch.expand("actuator_gainprm"))
        self._bias = np.asarray(batch.expand("actuator_biasprm"))
        self._range = np.asarray(batch.expand("actuator_forcerange"))
        self._damping = np.asarray(batch.expand("dof_damping"))
        self._gain[:, self._actuators, 0] = kp
        self._bias[:, self._actuators, 1] = -kp
        self._bias[:, self._actuators, 2] = -self.law["kd"]
        np.asarray(batch.expand("actuator_forcelimited"))[:, self._actuators] = 1
        self._limit = np.minimum(self.law["limit"], UNLIMITED_NM)
        self._set_range(self._limit)
        self._dofs = columns(plant.dofs)
        self._damping[:, self._dofs] += self.law["emf"] - plant.servo.back_emf_nm_s_rad
        model = plant.model
        diagonal = model.M_rowadr + model.M_rownnz - 1
        self._mass = np.asarray(batch.bind("M")), diagonal[self._dofs]
        self._more = np.zeros_like(kp)
        # limits of the next step, and whether actuators' present ones are not `_limit`
        self._least_limit, self._changed = self._limit, False

    @property
    def damping_nm_s_rad(self) -> FloatArray:
        """(rows, j) sum of servo damping, back-EMF and the joint's own damping.

        Not that of `damp_more`.
        """
        own = self._damping[:, self._dofs] - self._more
        return np.asarray(self.law["kd"] + own)

    @property
    def inertia_kg_m2(self) -> FloatArray:
        """(rows, j) inertia at each joint with all others held, as of the last step."""
        mass, diagonal = self._mass
        return np.asarray(mass[:, diagonal])

    def damp_more(self, damping_nm_s_rad: FloatArray) -> None:
        """Damp the joints in the next step by (rows, j) more than their own damping."""
        own = self._damping[:, self._dofs] - self._more
        self._damping[:, self._dofs] = own + damping_nm_s_rad
        self._more = damping_nm_s_rad

    def held_from_nm(self) -> FloatArray:
        """(rows, j) torque [N m] from which on a servo saturates in all of a step.

        One whose torque is below leaves saturation within the step: see `limit`.
        """
        inertia = self.inertia_kg_m2 + self._step_s * self._damping[:, self._dofs]
        return np.asarray(self._limit * (1 + self._step_s * self.law["kd"] / inertia))

    def equal(
        self, mean_rad: FloatArray, ends: Ends, angle: FloatArray, velocity: FloatArray
    ) -> FloatArray:
        """(rows, j) constant targets with the same mean torque as targets that jump.

        A target that jumps within a physics step may saturate the servo for a part of
        the step only. With the mean target MuJoCo would saturate it for all of it. What
        saturates is not damped. So where a servo saturates in most of a step, it gets
        the mean torque as its limit in the next call of `limit`; otherwise that torque
        for a part of the step from which on it would saturate in all of it.
        Angles [rad] are those that the servos control.
        """
        kp, kd, limit = (self.law[name] for name in ("kp", "kd", "limit"))
        held_from = self.held_from_nm()
        share = first_share(mean_rad, ends)
        parts = share, 1 - share
        asked = [kp * (end - angle) - kd * velocity for end in ends]
        mean_nm, damped_nm = (
            sum(
                part * np.clip(one, -most, most)
                for part, one in zip(parts, asked, strict=True)
            )
            for most in (limit, held_from)
        )
        jumps = np.abs(ends[1] - ends[0]) > self.least_jump_rad
        within = jumps & (share > 0) & (share < 1) & (kp > 0)
        target = angle + (damped_nm + kd * velocity) / np.maximum(kp, LEAST_KP)
        target = np.where(within & (np.abs(damped_nm) < held_from), target, mean_rad)
        for part, one, end in zip(parts, asked, ends, strict=True):
            long = within & (part > MOST_OF_STEP) & (np.abs(one) > held_from)
            target = np.where(long, end, target)
            if long.any():
                self._least_limit = np.where(long, np.abs(mean_nm), self._least_limit)
        return np.asarray(target)

    def limit(
        self, asked_rad: FloatArray, angle: FloatArray, velocity: FloatArray
    ) -> None:
        """Saturate only the servos that are still saturated when the step ends.

        MuJoCo decides as a step begins, and leaves out the damping kd of servos that
        saturate. But a light joint may become so fast within the step that damping
        takes the torque below the limit: only I / (I + step * kd) of it is left, with I
        the joint's inertia. Without this check, speeds would jump at the limit. Arrays
        are (rows, j).
        """
        kp, kd = self.law["kp"], self.law["kd"]
        torque = np.abs(kp * (asked_rad - angle) - kd * velocity)  # without a limit
        free = torque > self._limit
        if free.any():
            free &= torque < self.held_from_nm()
        changed = bool(free.any()) or self._least_limit is not self._limit
        if changed or self._changed:
            self._set_range(np.where(free, UNLIMITED_NM, self._least_limit))
        self._changed, self._least_limit = changed, self._limit

    def _set_range(self, limit: FloatArray) -> None:
        """Set torque limits (rows, j) [N m] of all actuators."""
        self._range[:, self._actuators, 0] = -limit
        self._range[:, self._actuators, 1] = limit

    def weaken(self, time_s: FloatArray, driven_nm: FloatArray) -> None:
        """Set the gains of servos that change, at (R,) times [s], one for each run.

        `driven_nm` (rows, j) are the torques of motors [N m], back-EMF included, under
        which the supply gives way: those of the step before.
        """
        on = self.on_share(time_s)
        if self._sags:
            lost = np.sum(self._joints["sag_1_nm"] * np.abs(driven_nm), axis=1)
            voltage = np.maximum(1 - lost, LEAST_VOLTAGE)[:, None]
            on = on * voltage
            self._hold_below(self._full_limit * voltage)
        time_s = np.tile(time_s, len(self._full_kp) // len(time_s))[:, None]
        left = np.maximum(1 - self._joints["fade_1_s"] * time_s, 0) * on
        self.law["kp"] = kp = self._full_kp * left  # also for motors of elastic joints
        self.law["kd"] = kd = self._full_kd * on
        laws = (self._gain, 0, kp), (self._bias, 1, -kp), (self._bias, 2, -kd)
        for field, column, value in laws:
            old = field[:, self._actuators, column]
            field[:, self._actuators, column] = np.where(self._stiff, value, old)

    def _hold_below(self, limit_nm: FloatArray) -> None:
        """Take other torque limits (rows, j) [N m], from the next `limit` on."""
        self.law["limit"] = limit_nm  # also for motors of elastic joints
        own = np.where(self._stiff, limit_nm, UNLIMITED_NM)
        self._limit = self._least_limit = np.minimum(own, UNLIMITED_NM)
        self._changed = True

    def on_share(self, time_s: FloatArray) -> FloatArray | float:
        """(rows, j) share of motor torque in the step that begins at (R,) times [s].

        1 unless a motor is off for a part of the step or all of it.
        """
        if not self._goes_off:
            return 1.0
        begin = np.tile(time_s, len(self._full_kp) // len(time_s))[:, None]
        since = np.maximum(begin, self._joints["off_start_s"])
        until = np.minimum(begin + self._step_s, self._joints["off_end_s"])
        share = np.clip((until - since) / self._step_s, 0.0, 1.0)
        return np.asarray(1 - self._joints["off_share"] * share)

    def soften(self, elastic: ElasticJoints, step_s: float) -> None:
        """Turn actuators of elastic joints into springs between motors and links."""
        stiffness, damping = elastic.stiffness, elastic.damping
        for field, column, value in (
            (self._gain, 0, stiffness),
            (self._bias, 1, -stiffness),
            (self._bias, 2, -damping - step_s * stiffness),
        ):
            old = field[:, self._actuators, column]
            field[:, self._actuators, column] = np.where(elastic.soft, value, old)
        self._limit = np.where(elastic.soft, UNLIMITED_NM, self._limit)
        self._least_limit = self._limit
        self._set_range(self._limit)
        self._damping[:, self._dofs] -= np.where(elastic.soft, self.law["emf"], 0.0)


def first_share(mean_rad: FloatArray, ends: Ends) -> FloatArray:
    """(rows, j) share of a physics step in which its first target holds; 0 if it stays.

    `mean_rad` (rows, j) is the step's mean target, `ends` are its first and last one.
    """
    before, after = ends
    jump = after - before
    nothing = np.zeros_like(jump)
    return np.divide(after - mean_rad, jump, out=nothing, where=jump != 0)


def servo_laws(
    servos: Sequence[Servo], joints: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """Gains and limits (rows, j) of the runs' servos, changed as the variants say."""
    n = len(joints["kp_factor"]) // len(servos)
    kp = np.tile([servo.kp_nm_rad for servo in servos], (n, 1))
    kd = np.tile([servo.kd_nm_s_rad for servo in servos], (n, 1))
    limit = np.tile([servo.max_torque_nm for servo in servos], (n, 1))
    emf = np.tile([servo.back_emf_nm_s_rad for servo in servos], (n, 1))
    return {
        "kp": kp * joints["kp_factor"],
        "kd": kd * joints["damping_factor"],
        "limit": np.minimum(limit, joints["max_torque_nm"]),
        "emf": emf * joints["damping_factor"],
    }
