"""Constants of the walk engine that are the same for all gaits."""

import math
from dataclasses import dataclass, fields, replace

from groundwalk.errors import BadValueError
from robots.scale import Scale

STANDARD_GRAVITY_M_S2 = 9.80665

_UNITS = {"_m_s": "m/s", "_rad_s": "rad/s", "_s": "s", "_n": "N"}
"""Units of the constants that scale with a robot's size, by the end of their names."""


@dataclass(frozen=True)
class EngineConfig:
    """Constants of Walk2014 (rUNSWift 2014 release), sized for NAO.

    Attributes:
      max_left_m_s: largest speed to the side (Walk2014).
      max_turn_rad_s: largest rate of turn (Walk2014).
      side_step_extra_s: extra duration of a step at the largest side speed; it is
        proportional to the side speed (Walk2014).
      left_calibration: ratio of the side step that is made to the requested one
        (Walk2014).
      lift_slope_left: foot lift added per metre of side step in a cycle (Walk2014).
      outward_turn_share: share of a turn that the outer foot takes (Walk2014).
      timeout_periods: number of periods after which a step ends even if the support
        foot has not changed (Walk2014).
      com_offset_speed_m_s: forward speed at which com_offset_speed_gain acts in full.
      posture_s: duration of crouching and of rising (Walk2014).
      stretch: leg length when standing, as a share of the straight leg's; it puts the
        NAO's hips at 0.248 m as in Walk2014.
      shoulder_roll_rad: angle of the arms away from the body (Walk2014).
      speed_fraction: share of a motor's no-load speed that commands may use (Walk2014).
      gyro_filter_tick_s: tick for which the gait parameter gyro_filter is given
        (Walk2014).
      sensor_start_n: initial scale of a force sensor, which then grows to its largest
        reading; Walk2014 has 0.1 of its sensors' unit, the weight of one kilogram.
      sensor_full_n: largest scale of a force sensor; Walk2014 has 5.0 of that unit.

    Example:
      >>> EngineConfig(posture_s=1.0).posture_s
      1.0
    """

    max_left_m_s: float = 0.2
    max_turn_rad_s: float = 0.87
    side_step_extra_s: float = 0.05
    left_calibration: float = 0.82
    lift_slope_left: float = 0.02
    outward_turn_share: float = 0.67
    timeout_periods: float = 3.0
    com_offset_speed_m_s: float = 0.3
    posture_s: float = 0.5
    stretch: float = 0.9996
    shoulder_roll_rad: float = math.radians(7)
    speed_fraction: float = 0.9
    gyro_filter_tick_s: float = 0.01
    sensor_start_n: float = 0.1 * STANDARD_GRAVITY_M_S2
    sensor_full_n: float = 5.0 * STANDARD_GRAVITY_M_S2

    def __post_init__(self) -> None:
        """Refuse constants that are not positive, and shares above one."""
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0):
                raise BadValueError(f"engine {name} is {value}; it must be positive")
        for name in ("outward_turn_share", "stretch", "speed_fraction"):
            if getattr(self, name) > 1:
                raise BadValueError(
                    f"engine {name} is {getattr(self, name)}; it must not exceed 1"
                )

    def scaled(self, scale: Scale) -> "EngineConfig":
        """Convert the constants to a robot of another size than the NAO."""
        changes = {}
        for field in fields(self):
            ends = (end for end in _UNITS if field.name.endswith(end))
            factor = scale.of(_UNITS.get(next(ends, ""), "1"))
            changes[field.name] = getattr(self, field.name) * factor
        return replace(self, **changes)


WALK2014_CONFIG = EngineConfig()
"""The constants of Walk2014 for the NAO."""
