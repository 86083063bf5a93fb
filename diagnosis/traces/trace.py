"""A recording made ready to be held against a plant."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from diagnosis.plant.servo import Servo
from groundwalk.arrays import FloatArray

JOINT_WISE = (
    *("position_rad", "velocity_rad_s", "torque_nm", "added_nm"),
    *("command_rad", "command_torque_nm"),
)
"""What a trace has for each joint."""


@dataclass(frozen=True, eq=False)
class Trace:
    """One recording, or a contiguous part of one; columns in the plant's joint order.

    T ticks at uneven times; NaN is a missing value, None a channel that is not there.
    Row k was measured at `time_s[k]` before `command_rad[k]` took effect, which holds
    until `time_s[k + 1]`.

    Attributes:
      name: of the recording.
      time_s: (T,) increasing.
      position_rad: (T, j) measured.
      servo: of this recording.
      velocity_rad_s: (T, j) measured.
      command_rad: (T, j) position targets.
      command_torque_nm: (T, j) torque targets.
      torque_nm: (T, j) measured.
      added_nm: (T, j) torques that drive the joints beside their servos.
      gyroscope_rad_s: (T, 3) in the sensor's frame.
      accelerometer_m_s2: (T, 3) in the sensor's frame.
      foot_force_n: (T, feet) vertical, one sum a foot.
      base_position_m: (T, 3) world frame.
      base_orientation: (T, 4) w, x, y, z, base to world.
      base_linear_velocity_m_s: (T, 3) world frame.
      base_angular_velocity_rad_s: (T, 3) body frame.
    """

    name: str
    time_s: FloatArray
    position_rad: FloatArray
    servo: Servo
    velocity_rad_s: FloatArray | None = None
    command_rad: FloatArray | None = None
    command_torque_nm: FloatArray | None = None
    torque_nm: FloatArray | None = None
    added_nm: FloatArray | None = None
    gyroscope_rad_s: FloatArray | None = None
    accelerometer_m_s2: FloatArray | None = None
    foot_force_n: FloatArray | None = None
    base_position_m: FloatArray | None = None
    base_orientation: FloatArray | None = None
    base_linear_velocity_m_s: FloatArray | None = None
    base_angular_velocity_rad_s: FloatArray | None = None

    @property
    def ticks(self) -> int:
        """Number of rows."""
        return len(self.time_s)

    @property
    def duration_s(self) -> float:
        """From the first to the last row."""
        return float(self.time_s[-1] - self.time_s[0])

    @property
    def tick_s(self) -> float:
        """Median time between rows."""
        return float(np.median(np.diff(self.time_s)))

    @property
    def unheld(self) -> bool:
        """Whether no servo holds a joint: measured or asked torques drive them."""
        return self.command_rad is None or not self.servo.kp_nm_rad.any()

    def of(self, columns: Sequence[int]) -> "Trace":
        """What concerns some joints, and what concerns none."""
        chosen = list(columns)
        changes = {
            name: values[:, chosen]
            for name in JOINT_WISE
            if (values := getattr(self, name)) is not None
        }
        return replace(self, servo=self.servo.of(chosen), **changes)

    def part(self, start: int, stop: int) -> "Trace":
        """Rows `start` to `stop - 1`; the name says which."""
        rows = slice(start, stop)
        changes = {
            field.name: getattr(self, field.name)[rows]
            for field in fields(self)
            if isinstance(getattr(self, field.name), np.ndarray)
        }
        name = f"{self.name}[{self.time_s[start]:.3g}-{self.time_s[stop - 1]:.3g} s]"
        return replace(self, name=name, **changes)


def filled(values: FloatArray) -> FloatArray:
    """(T, j) missing values replaced by those before, leading ones by the first."""
    rows = np.arange(len(values))[:, None]
    last = np.maximum.accumulate(np.where(np.isnan(values), -1, rows), axis=0)
    first = np.argmax(~np.isnan(values), axis=0)
    last = np.where(last < 0, first, last)
    return np.nan_to_num(np.take_along_axis(values, last, axis=0))
