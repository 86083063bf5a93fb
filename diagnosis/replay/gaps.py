"""Play between the motors and joints of a batch of simulations."""

from collections.abc import Mapping

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray

LEAST_DRAG = 1e-9
"""What has neither stiffness nor damping does not move: nothing is divided by zero."""


class BatchGaps:
    """Motors that turn within their gaps, free of the joint, until they touch it.

    A motor is without mass, as its inertia is part of the joint's. Free of the joint it
    follows its command by its own servo, m' = kp (command - m) / (kd + back-EMF), and
    no torque reaches the joint. It touches at half the gap from the joint's position.

    Source: Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model, with a motor whose damping outweighs its inertia.
    """

    def __init__(
        self,
        joints: Mapping[str, FloatArray],
        law: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Take the gaps of all variants.

        Args:
          joints: `Joints`, rows as the batch has them.
          law: `kp`, `kd`, `limit` and `emf` of the servos, as they are at any time.
          step_s: of the physics.
        """
        self._half = joints["gap_rad"] / 2
        self._law, self._step_s = law, step_s
        self._motor_rad: FloatArray | None = None

    def begin(self) -> None:
        """Begin, or begin anew: motors are where their commands let them be."""
        self._motor_rad = None

    def through(
        self, asked_rad: FloatArray, position: FloatArray
    ) -> tuple[FloatArray, BoolArray]:
        """Targets (rows, j) that give the torque that arrives, and where none does.

        Args:
          asked_rad: position targets.
          position: of the joints.
        """
        half = self._half
        low, high = position - half, position + half
        if self._motor_rad is None:
            self._motor_rad = np.clip(asked_rad, low, high)
        free = self._followed(asked_rad, self._motor_rad)
        apart: BoolArray = (free > low) & (free < high)
        self._motor_rad = np.clip(free, low, high)
        arrives = np.where(apart, 0.0, asked_rad - self._motor_rad)
        return position + arrives, apart

    def drag_nm(self, velocity: FloatArray) -> FloatArray:
        """(rows, j) by which the servo brakes: a joint lacks it while apart from it.

        Args:
          velocity: of the joints.
        """
        law = self._law
        servo_nm = np.clip(law["kd"] * velocity, -law["limit"], law["limit"])
        return np.asarray(servo_nm + law["emf"] * velocity)

    def _followed(self, asked_rad: FloatArray, motor_rad: FloatArray) -> FloatArray:
        """One implicit step of motors that nothing holds, within their torque."""
        law = self._law
        drag = np.maximum(law["kd"] + law["emf"], LEAST_DRAG) / self._step_s
        moved = law["kp"] * (asked_rad - motor_rad) / (law["kp"] + drag)
        emf = np.maximum(law["emf"], LEAST_DRAG)
        most = self._step_s * law["limit"] / emf
        return np.asarray(motor_rad + np.clip(moved, -most, most))
