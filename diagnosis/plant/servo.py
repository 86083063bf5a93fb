"""What holds each joint of a plant at its command."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError


@dataclass(frozen=True, eq=False)
class Servo:
    """The servos of all j joints.

    Torque = clip(kp (command - q) - kd v, +-max_torque) - back_emf v: what a firmware
    asks for is limited, what the turning motor induces is not. For sliding joints read
    N for N m and m for rad.

    Attributes:
      kp_nm_rad: (j,) stiffness.
      kd_nm_s_rad: (j,) damping within the limit.
      max_torque_nm: (j,) limit; infinite where there is none.
      back_emf_nm_s_rad: (j,) damping beside the limit.
    """

    kp_nm_rad: FloatArray
    kd_nm_s_rad: FloatArray
    max_torque_nm: FloatArray
    back_emf_nm_s_rad: FloatArray

    def __post_init__(self) -> None:
        """Refuse servos that push the wrong way."""
        for name, values in vars(self).items():
            if values.shape != self.kp_nm_rad.shape:
                raise BadValueError(f"{name} must have one value for each joint")
            if np.isnan(values).any() or (values < 0).any():
                raise BadValueError(f"{name} must not be negative: {values}")

    def of(self, columns: Sequence[int]) -> "Servo":
        """Those of some joints."""
        return Servo(*(values[list(columns)] for values in vars(self).values()))

    @classmethod
    def ideal(cls, joints: int) -> "Servo":
        """No servo at all: for joints that are driven by torque."""
        zero = np.zeros(joints)
        return cls(zero, zero, np.full(joints, np.inf), zero)
