"""Simulates gaps (backlash) between motors and joints in a batch of simulations."""

from collections.abc import Mapping

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray

LEAST_DRAG = 1e-9
"""Smallest damping [N m s/rad] used as a divisor, to avoid division by zero; a motor
without stiffness and damping then does not move."""


class BatchGaps:
    """Motors that turn freely within their gaps until they touch the joint.

    A motor has no inertia here, since its inertia is part of the joint's. While it is
    free, its servo moves its angle m by m' = kp (command - m) / (kd + back-EMF), and no
    torque reaches the joint. It touches the joint at half the gap from its position.

    Source: Nordin and Gutman 2002, "Controlling mechanical systems with backlash: a
    survey", the dead-zone model, with a motor whose damping outweighs its inertia.
    """

    def __init__(
        self,
        joints: Mapping[str, FloatArray],
        law: Mapping[str, FloatArray],
        step_s: float,
    ) -> None:
        """Prepare gaps of (rows, j) `joints` with servos of a `law`, which may fade."""
        self._half = joints["gap_rad"] / 2
        self._law, self._step_s = law, step_s
        self._motor_rad: FloatArray | None = None

    def begin(self) -> None:
        """Forget the motors' angles; they start as near their targets as gaps allow."""
        self._motor_rad = None

    def through(
        self, asked_rad: FloatArray, position: FloatArray
    ) -> tuple[FloatArray, BoolArray]:
        """Step the motors once; targets for rigid servos, and flags of free motors.

        With these targets (rows, j) [rad] a servo without gap gives the torque that
        gets through the gap. Flags (rows, j) are true where no torque does.
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
        """Damping torque [N m] of servos whose motors are free, at (rows, j) speeds."""
        law = self._law
        servo_nm = np.clip(law["kd"] * velocity, -law["limit"], law["limit"])
        return np.asarray(servo_nm + law["emf"] * velocity)

    def _followed(self, asked_rad: FloatArray, motor_rad: FloatArray) -> FloatArray:
        """(rows, j) angles of free motors after one implicit step, torque limited."""
        law = self._law
        drag = np.maximum(law["kd"] + law["emf"], LEAST_DRAG) / self._step_s
        moved = law["kp"] * (asked_rad - motor_rad) / (law["kp"] + drag)
        emf = np.maximum(law["emf"], LEAST_DRAG)
        most = self._step_s * law["limit"] / emf
        return np.asarray(motor_rad + np.clip(moved, -most, most))
