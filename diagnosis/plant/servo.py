"""The servos that drive a robot model's joints towards their commands."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError


def servo_torque(
    kp_nm_rad: FloatArray,
    kd_nm_s_rad: FloatArray,
    max_torque_nm: FloatArray,
    error_rad: FloatArray,
    velocity_rad_s: FloatArray,
) -> FloatArray:
    """The torque that servos ask for: clip(kp error - kd velocity, +-max_torque).

    The motors' back-EMF is not included. The error is the position command less the
    measured position; all arguments have shapes that broadcast against each other.
    """
    asked = kp_nm_rad * error_rad - kd_nm_s_rad * velocity_rad_s
    return np.asarray(np.clip(asked, -max_torque_nm, max_torque_nm))


@dataclass(frozen=True, eq=False)
class Servo:
    """The servos of all j joints of a robot model.

    Their torque is clip(kp error - kd velocity, +-max_torque) - back_emf velocity,
    error being command less position: the firmware limits the torque that it asks for,
    but not the back-EMF of the motor. Sliding joints have N for N m and m for rad.

    Attributes:
      kp_nm_rad: (j,) stiffness.
      kd_nm_s_rad: (j,) damping, inside the torque limit.
      max_torque_nm: (j,) torque limit; infinite where there is none.
      back_emf_nm_s_rad: (j,) damping outside the torque limit.

    Raises:
      BadValueError: a value is negative or NaN, or the arrays differ in length.
    """

    kp_nm_rad: FloatArray
    kd_nm_s_rad: FloatArray
    max_torque_nm: FloatArray
    back_emf_nm_s_rad: FloatArray

    def __post_init__(self) -> None:
        """Refuse negative values and arrays of unequal lengths."""
        for name, values in vars(self).items():
            if values.shape != self.kp_nm_rad.shape:
                raise BadValueError(f"{name} must have one value for each joint")
            if np.isnan(values).any() or (values < 0).any():
                raise BadValueError(f"{name} must not be negative: {values}")

    def torque(self, error_rad: FloatArray, velocity_rad_s: FloatArray) -> FloatArray:
        """(..., j) torques [N m] that the servos ask for, see `servo_torque`."""
        gains = self.kp_nm_rad, self.kd_nm_s_rad, self.max_torque_nm
        return servo_torque(*gains, error_rad, velocity_rad_s)

    def of(self, columns: Sequence[int]) -> "Servo":
        """The servos of the joints with these indices."""
        return Servo(*(values[list(columns)] for values in vars(self).values()))

    @classmethod
    def ideal(cls, joints: int) -> "Servo":
        """Servos of `joints` joints without stiffness, damping, limit and back-EMF."""
        zero = np.zeros(joints)
        return cls(zero, zero, np.full(joints, np.inf), zero)
