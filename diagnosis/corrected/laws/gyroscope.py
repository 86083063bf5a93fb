"""A gyroscope that shows a turn rate even when nothing turns."""

from collections.abc import Mapping

import mujoco

from diagnosis.corrected.laws.step import Joint, Law


class GyroscopeBias(Law):
    """A constant error x, y, z [rad/s] of the gyroscope, about the sensor's axes."""

    def __init__(
        self,
        model: mujoco.MjModel,
        joints: Mapping[str, Joint],
        x: float,
        y: float,
        z: float,
    ) -> None:
        """Set the error; it changes nothing but readings."""
        self.gyroscope_bias = (x, y, z)
