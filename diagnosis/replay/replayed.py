"""What would have been measured in one run."""

from dataclasses import dataclass

from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Replayed:
    """What n variants would have measured in one run, at the rows of its trace.

    Attributes:
      position_rad: (n, T, j).
      velocity_rad_s: (n, T, j).
      servo_nm: (n, T, j) what the servos gave, without back-EMF.
      base: (n, T, 13) as `Run.base`, for a floating base.
      gyroscope_rad_s: (n, T, 3).
    """

    position_rad: FloatArray
    velocity_rad_s: FloatArray
    servo_nm: FloatArray
    base: FloatArray | None
    gyroscope_rad_s: FloatArray
