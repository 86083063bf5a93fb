"""The servos of the joints in a batch of simulations."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo, servo_torque
from diagnosis.replay.columns import columns
from diagnosis.replay.elastic import ElasticJoints
from groundwalk.arrays import FloatArray

SERVO = ("kp_nm_rad", "kd_nm_s_rad", "max_torque_nm", "back_emf_nm_s_rad")
UNLIMITED_NM = 1e9
LEAST_KP = 1e-9
JUMP = 0.3
"""Of what takes a servo to its limit: so large is a jump of its target."""

Ends = tuple[FloatArray, FloatArray]
"""Targets as a step begins, and as it ends: (rows, j) each."""


class BatchServos:
    """MuJoCo's affine actuators, each with the law of its own run and variant.

    Attributes:
      law: (rows, j) `kp`, `kd`, `limit` and `emf` as they are now.
    """

    def __init__(
        self,
        batch: Any,
        plant: Plant,
        servos: Sequence[Servo],
        joints: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Set each run's own servos, times what the variants change of them.

        Args:
          batch: a `mujoco.batch.Batch`.
          plant: that it simulates.
          servos: of R runs, one after another for each variant.
          joints: `Joints`, rows as the batch has them.
          step_s: of the physics.
        """
        self._joints, self._actuators = joints, columns(plant.actuators)
        self.fades = bool(joints["fade_1_s"].any())
        """Whether any servo grows weaker with time."""
        self.law = _laws(servos, joints)
        self._full_kp = kp = self.law["kp"]
        self._gain, self._bias, self._range, self._damping, limited = (
            np.asarray(batch.expand(name))
            for name in (
                "actuator_gainprm",
                "actuator_biasprm",
                "actuator_forcerange",
                "dof_damping",
                "actuator_forcelimited",
            )
        )
        self._gain[:, self._actuators, 0] = kp
        self._bias[:, self._actuators, 1] = -kp
        self._bias[:, self._actuators, 2] = -self.law["kd"]
        limited[:, self._actuators] = 1
        self._limit = np.minimum(self.law["limit"], UNLIMITED_NM)
        self._set_range(self._limit)
        self._dofs = columns(plant.dofs)
        self._damping[:, self._dofs] += self.law["emf"] - plant.servo.back_emf_nm_s_rad
        inertia = np.asarray(batch.expand("dof_M0"))[:, self._dofs]
        inertia = inertia + step_s * self._damping[:, self._dofs]
        # who is asked for less has left the limit when the step ends
        self._held_from = self._limit * (1 + step_s * self.law["kd"] / inertia)
        self._relaxed = False  # whether some range is wider than its limit now

    @property
    def least_jump_rad(self) -> FloatArray:
        """(rows, j) by which a target changes that jumps."""
        reach = self.law["limit"] / np.maximum(self._full_kp, LEAST_KP)
        return np.asarray(JUMP * reach)

    @property
    def damping_nm_s_rad(self) -> FloatArray:
        """(rows, j) of servos, motors and joints: all that is viscous."""
        return np.asarray(self.law["kd"] + self._damping[:, self._dofs])

    def equal(
        self, mean_rad: FloatArray, ends: Ends, angle: FloatArray, velocity: FloatArray
    ) -> FloatArray:
        """(rows, j) constant targets that give the torque of those that jump in a step.

        At the mean target a servo at its limit would give the whole torque of the new
        one, though it has only had it for a part of the step.

        Args:
          mean_rad: of the targets over the step.
          ends: the targets.
          angle: of the servos, (rows, j).
          velocity: likewise.
        """
        kp, kd, limit = (self.law[name] for name in ("kp", "kd", "limit"))
        share = first_share(mean_rad, ends)
        first, last = (
            servo_torque(kp, kd, limit, end - angle, velocity) for end in ends
        )
        torque = share * first + (1 - share) * last
        target = angle + (torque + kd * velocity) / np.maximum(kp, LEAST_KP)
        jumps = np.abs(ends[1] - ends[0]) > self.least_jump_rad
        # at its limit all the time a servo gives that at the mean target, too
        within = (share > 0) & (share < 1) & (np.abs(torque) < limit) & (kp > 0)
        return np.where(jumps & within, target, mean_rad)

    def limit(
        self, asked_rad: FloatArray, angle: FloatArray, velocity: FloatArray
    ) -> None:
        """Let servos be at their limits if they still are when a step ends.

        MuJoCo asks as a step begins, and has no damping of a servo at its limit. But in
        one step a light joint may become so fast that its damping takes the torque
        well below: I / (I + step * kd) of it is left, which decides here. Otherwise
        speeds would jump with what is just at the limit and what is just below.

        Args:
          asked_rad: targets of the step, (rows, j).
          angle: of the servos, likewise.
          velocity: likewise.
        """
        kp, kd = self.law["kp"], self.law["kd"]
        unlimited = np.asarray(np.inf)
        torque = np.abs(servo_torque(kp, kd, unlimited, asked_rad - angle, velocity))
        free = (torque > self._limit) & (torque < self._held_from)
        relaxed = bool(free.any())
        if relaxed or self._relaxed:
            self._set_range(np.where(free, UNLIMITED_NM, self._limit))
        self._relaxed = relaxed

    def _set_range(self, limit: FloatArray) -> None:
        self._range[:, self._actuators, 0] = -limit
        self._range[:, self._actuators, 1] = limit

    def fade(self, time_s: FloatArray) -> None:
        """Set the stiffness of (R,) times."""
        time_s = np.tile(time_s, len(self._full_kp) // len(time_s))[:, None]
        left = np.clip(1 - self._joints["fade_1_s"] * time_s, 0, None)
        self.law["kp"] = kp = self._full_kp * left  # motors of elastic joints, too
        stiff = np.isinf(self._joints["spring_nm_rad"])
        for field, column, value in ((self._gain, 0, kp), (self._bias, 1, -kp)):
            old = field[:, self._actuators, column]
            field[:, self._actuators, column] = np.where(stiff, value, old)

    def soften(self, elastic: ElasticJoints, step_s: float) -> None:
        """Elastic joints: the actuator is the spring, the motor turns beside it."""
        stiffness, damping = elastic.stiffness, elastic.damping
        for field, column, value in (
            (self._gain, 0, stiffness),
            (self._bias, 1, -stiffness),
            (self._bias, 2, -damping - step_s * stiffness),
        ):
            old = field[:, self._actuators, column]
            field[:, self._actuators, column] = np.where(elastic.soft, value, old)
        self._limit = np.where(elastic.soft, UNLIMITED_NM, self._limit)
        self._set_range(self._limit)
        self._damping[:, self._dofs] -= np.where(elastic.soft, self.law["emf"], 0.0)


def first_share(mean_rad: FloatArray, ends: Ends) -> FloatArray:
    """(rows, j) share of a step in which its first target holds; 0 if none changes."""
    before, after = ends
    jump = after - before
    nothing = np.zeros_like(jump)
    return np.divide(after - mean_rad, jump, out=nothing, where=jump != 0)


def _laws(
    servos: Sequence[Servo], joints: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    n = len(joints["kp_factor"]) // len(servos)
    kp, kd, limit, emf = (
        np.tile([getattr(servo, name) for servo in servos], (n, 1)) for name in SERVO
    )
    return {
        "kp": kp * joints["kp_factor"],
        "kd": kd * joints["damping_factor"],
        "limit": np.minimum(limit, joints["max_torque_nm"]),
        "emf": emf * joints["damping_factor"],
    }
