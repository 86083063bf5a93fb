"""Servos of joints, as affine actuators of MuJoCo, and dry friction in a batch."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo
from diagnosis.replay.dry_friction import (
    SHARES_OF_LINKS,
    VARYING,
    DryFriction,
    depends_on,
)
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

Columns = slice | list[int]
"""Index of the joints' columns in an array of MuJoCo."""

Ends = tuple[FloatArray, FloatArray]
"""Position targets (rows, j) [rad] as a physics step begins, and as it ends."""


def columns(numbers: Sequence[int]) -> Columns:
    """Index of these columns: a slice if possible, since that avoids copies."""
    first, count = numbers[0], len(numbers)
    if list(numbers) == list(range(first, first + count)):
        return slice(first, first + count)
    return list(numbers)


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


SOLIMP_FRICTION = (0.9999, 0.9999, 0.001, 0.5, 2.0)
"""MuJoCo's `solimp` (impedance d) of dry friction: the largest one that it allows.

A joint with damping D that friction T holds creeps at about (1 - d) T / D [rad/s]: at a
tenth of it by MuJoCo's default, and still by some mrad in 10 s with d = 0.999."""


class BatchFriction:
    """Sets MuJoCo's dry friction (`frictionloss`) of all joints in all simulations.

    Attributes:
      varies: whether some friction depends on speed, angle or load; if so, call
        `follow` at every step.
    """

    def __init__(
        self,
        batch: Any,
        plant: Plant,
        joints: Mapping[str, FloatArray],
        damping_nm_s_rad: FloatArray,
        step_s: float,
    ) -> None:
        """Set the friction torques that do not change.

        `joints` are arrays of `Joints` by name with a row for each simulation in the
        batch, `damping_nm_s_rad` (rows, j) all damping that is integrated implicitly.
        """
        self._joints, self._dofs = joints, columns(plant.dofs)
        self.varies = depends_on(joints, VARYING)
        self._bias: FloatArray | None = None
        if depends_on(joints, SHARES_OF_LINKS):
            self._bias = np.asarray(batch.bind("qfrc_bias"))
        self._torque_nm = np.asarray(batch.expand("dof_frictionloss"))
        self._torque_nm[:, self._dofs] += joints["coulomb_nm"]
        self._least_nm = self._torque_nm[:, self._dofs].copy()
        if plant.creeps:
            return
        np.asarray(batch.expand("dof_solimp"))[:] = SOLIMP_FRICTION
        inertia_kg_m2 = np.asarray(batch.expand("dof_M0"))
        damping = np.zeros_like(inertia_kg_m2)
        damping[:, self._dofs] = damping_nm_s_rad
        solref = stops_in_a_step(damping, inertia_kg_m2, step_s)
        np.asarray(batch.expand("dof_solref"))[:] = solref

    def follow(
        self,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        driven_nm: FloatArray,
    ) -> None:
        """Set friction by (rows, j) angles, speeds [rad/s] and motors' torques [N m].

        The links' torques are those of the step before, as are the motors'.
        """
        links_nm = 0.0 if self._bias is None else -self._bias[:, self._dofs]
        friction = DryFriction(self._joints, velocity_rad_s, links_nm, position_rad)
        self._torque_nm[:, self._dofs] = self._least_nm + friction.at(driven_nm)


def stops_in_a_step(
    damping_nm_s_rad: FloatArray, inertia_kg_m2: FloatArray, step_s: float
) -> FloatArray:
    """(..., 2) MuJoCo's `solref` for friction that can stop a joint within one step.

    MuJoCo's friction asks for the acceleration -rate * velocity as if there were no
    damping. Its integrator, where damping is implicit, gives only the share I / (I +
    step * damping) of that, with I the inertia at the joint with the links beyond it.
    With the usual rate, 1 / step, a light joint with a strong servo creeps on for
    seconds. (MuJoCo documentation, "Computation": implicit integrators, and "Modeling",
    solref: two negative numbers mean stiffness, which friction does not have, and
    damping.)
    """
    rate_1_s = 1 / step_s + damping_nm_s_rad / inertia_kg_m2
    damping = -SOLIMP_FRICTION[1] * rate_1_s
    return np.stack([np.full_like(damping, -1.0), damping], axis=-1)
