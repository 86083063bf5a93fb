"""What a robot in a hidden world feels."""

from dataclasses import dataclass

from groundwalk.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class BodySense:
    """What the base's sensors and the feet feel, and where the base is.

    All in the frame of the mount or the ground. Zero where a robot has no such sensor.

    Attributes:
      gyroscope_rad_s, accelerometer_m_s2: (3,) base frame.
      foot_force_n: (8,) as in `worlds.Observation`.
      position_m: (3,), orientation: (4,) w, x, y, z.
      linear_m_s: (3,) ground frame, angular_rad_s: (3,) base frame.
    """

    gyroscope_rad_s: FloatArray
    accelerometer_m_s2: FloatArray
    foot_force_n: FloatArray
    position_m: FloatArray
    orientation: FloatArray
    linear_m_s: FloatArray
    angular_rad_s: FloatArray
