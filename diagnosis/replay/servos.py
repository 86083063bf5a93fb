"""Servos of the joints in a batch of simulations, as MuJoCo's affine actuators."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from diagnosis.plant.plant import Plant
from diagnosis.plant.servo import Servo, servo_torque
from diagnosis.replay.elastic import ElasticJoints
from groundwalk.arrays import FloatArray

SERVO = ("kp_nm_rad", "kd_nm_s_rad", "max_torque_nm", "back_emf_nm_s_rad")
"""The fields of a `Servo` that a servo's law is made of."""

UNLIMITED_NM = 1e9
"""Torque range [N m] that stands for none, since MuJoCo wants finite numbers."""

LEAST_KP = 1e-9
"""Smallest stiffness [N m/rad] that is divided by."""

JUMP = 0.3
"""A change of the target within one step counts as a jump if it exceeds this share of
the error that takes the servo to its limit. Smaller ones do not saturate a servo."""

Columns = slice | list[int]
"""Where the joints are in the arrays of a simulation."""

Ends = tuple[FloatArray, FloatArray]
"""Targets (rows, j) [rad] as a step begins, and as it ends."""


def columns(numbers: Sequence[int]) -> Columns:
    """Index of the joints' columns: a slice if possible, as views cost no copy.

    Args:
      numbers: column of each joint, in the order of the joints.
    """
    first, count = numbers[0], len(numbers)
    if list(numbers) == list(range(first, first + count)):
        return slice(first, first + count)
    return list(numbers)


class BatchServos:
    """MuJoCo's affine actuators, each with the law of its own run and variant.

    Attributes:
      law: the servos' numbers as they are now, arrays (rows, j): `kp` [N m/rad], `kd`
        [N m s/rad], `limit` [N m] and `emf`, the back-EMF [N m s/rad].
      fades: whether any servo becomes weaker with time.
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

        Args:
          batch: a `mujoco.batch.Batch`, variant by variant, run by run.
          plant: the simulated robot.
          servos: of the R runs.
          joints: arrays of `Joints`, with a row for each simulation.
          step_s: time step of the physics.
        """
        self._joints, self._actuators = joints, columns(plant.actuators)
        self.fades = bool(joints["fade_1_s"].any())
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
        # below this torque the servo leaves saturation within the step
        self._held_from = self._limit * (1 + step_s * self.law["kd"] / inertia)
        self._relaxed = False  # whether some range is wider than its limit now

    @property
    def least_jump_rad(self) -> FloatArray:
        """(rows, j) smallest change of a target [rad] that counts as a jump."""
        reach = self.law["limit"] / np.maximum(self._full_kp, LEAST_KP)
        return np.asarray(JUMP * reach)

    @property
    def damping_nm_s_rad(self) -> FloatArray:
        """(rows, j) damping of servos, motors and joints together."""
        return np.asarray(self.law["kd"] + self._damping[:, self._dofs])

    def equal(
        self, mean_rad: FloatArray, ends: Ends, angle: FloatArray, velocity: FloatArray
    ) -> FloatArray:
        """(rows, j) constant targets with the mean torque of targets that jump.

        A target that jumps within a step may saturate the servo for a part of the step
        only. With the mean target MuJoCo would saturate it for the whole step.

        Args:
          mean_rad: (rows, j) mean target of the step.
          ends: first and last target of the step.
          angle: (rows, j) of the servos [rad].
          velocity: (rows, j) of the servos [rad/s].
        """
        kp, kd, limit = (self.law[name] for name in ("kp", "kd", "limit"))
        share = first_share(mean_rad, ends)
        first, last = (
            servo_torque(kp, kd, limit, end - angle, velocity) for end in ends
        )
        torque = share * first + (1 - share) * last
        target = angle + (torque + kd * velocity) / np.maximum(kp, LEAST_KP)
        jumps = np.abs(ends[1] - ends[0]) > self.least_jump_rad
        # where the servo saturates all the time, the mean target is right as well
        within = (share > 0) & (share < 1) & (np.abs(torque) < limit) & (kp > 0)
        return np.where(jumps & within, target, mean_rad)

    def limit(
        self, asked_rad: FloatArray, angle: FloatArray, velocity: FloatArray
    ) -> None:
        """Saturate only the servos that are still saturated when the step ends.

        MuJoCo decides as a step begins, and then leaves out the servo's damping. Within
        one step a light joint may become so fast that damping takes the torque below
        the limit: of the torque I / (I + step * kd) is left, with I the joint's
        inertia. Without this check, speeds would jump at the limit.

        Args:
          asked_rad: (rows, j) targets of the step.
          angle: (rows, j) of the servos [rad].
          velocity: (rows, j) of the servos [rad/s].
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
        """Set the torque ranges (rows, j) of all actuators."""
        self._range[:, self._actuators, 0] = -limit
        self._range[:, self._actuators, 1] = limit

    def fade(self, time_s: FloatArray) -> None:
        """Set the stiffness at (R,) times [s] of fading servos."""
        time_s = np.tile(time_s, len(self._full_kp) // len(time_s))[:, None]
        left = np.clip(1 - self._joints["fade_1_s"] * time_s, 0, None)
        self.law["kp"] = kp = self._full_kp * left  # also for motors of elastic joints
        stiff = np.isinf(self._joints["spring_nm_rad"])
        for field, column, value in ((self._gain, 0, kp), (self._bias, 1, -kp)):
            old = field[:, self._actuators, column]
            field[:, self._actuators, column] = np.where(stiff, value, old)

    def soften(self, elastic: ElasticJoints, step_s: float) -> None:
        """Let the actuators of elastic joints be their springs.

        The motors of these joints are simulated by `ElasticJoints`.
        """
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
    """(rows, j) share of a step in which its first target holds; 0 without a change.

    Args:
      mean_rad: (rows, j) mean target of the step.
      ends: first and last target of the step.
    """
    before, after = ends
    jump = after - before
    nothing = np.zeros_like(jump)
    return np.divide(after - mean_rad, jump, out=nothing, where=jump != 0)


def _laws(
    servos: Sequence[Servo], joints: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """The servos' numbers (rows, j), changed as the variants say."""
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
