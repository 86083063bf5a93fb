"""LeRobot's calibration files, and the angles that its numbers stand for."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from groundwalk.errors import BadValueError, ForeignFileError
from groundwalk.json_data import from_plain, parse_json

TICKS = 4096
"""Steps of the servos' encoders in a turn; LeRobot's arms have such servos."""


@dataclass(frozen=True)
class MotorCalibration:
    """Calibration of one motor, as LeRobot writes it: all in steps of the encoder.

    Attributes:
      id: number of the motor on its bus.
      drive_mode: 1 if percentages count backwards, otherwise 0.
      homing_offset: what the motor itself subtracts; positions are without it.
      range_min: position at -100 (or 0) percent.
      range_max: position at 100 percent.
    """

    id: int
    drive_mode: int
    homing_offset: int
    range_min: int
    range_max: int

    def __post_init__(self) -> None:
        """Refuse ranges without extent, and unknown modes."""
        if self.range_max <= self.range_min:
            raise BadValueError(
                f"range_max is {self.range_max}; it must be above range_min, "
                f"{self.range_min}"
            )
        if self.drive_mode not in (0, 1):
            raise BadValueError(f"drive_mode is {self.drive_mode}; it must be 0 or 1")

    @property
    def rad_per_percent(self) -> float:
        """Angle of one of the 200 percent [rad]; negative if they count backwards."""
        range_rad = (self.range_max - self.range_min) * 2.0 * math.pi / TICKS
        return (-range_rad if self.drive_mode else range_rad) / 200.0


def read_calibration(path: Path) -> Mapping[str, MotorCalibration]:
    """Read LeRobot's calibration file: a JSON object of motors by name.

    Raises:
      ForeignFileError: the file is missing or no such JSON; names the motor and key.
    """
    try:
        plain = parse_json(path.read_bytes(), "the calibration")
        return from_plain(dict[str, MotorCalibration], plain, "calibration")
    except FileNotFoundError:
        raise ForeignFileError(f"{path}: no such file") from None
    except BadValueError as error:
        raise ForeignFileError(f"{path}: {error}") from None
