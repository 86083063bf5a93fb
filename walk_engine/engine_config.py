"""Constants of the walk engine that are the same for all gaits."""

import math
from dataclasses import dataclass, fields, replace

from groundwalk.errors import BadValueError
from robots.scale import Scale

STANDARD_GRAVITY_M_S2 = 9.80665

_UNITS = {"_m_s": "m/s", "_rad_s": "rad/s", "_s": "s", "_n": "N"}
"""Units of the attributes of `EngineConfig` by the end of their names; attributes with
other names are not scaled with a robot's size."""


@dataclass(frozen=True)
class EngineConfig:
    """Constants of the walk engine that are the same for all gaits, sized for the NAO.

    "(Walk2014)" marks values of the rUNSWift 2014 code release.

    Attributes:
      max_left_m_s: largest speed to the side [m/s] (Walk2014).
      max_turn_rad_s: largest rate of turn [rad/s] (Walk2014).
      side_step_extra_s: extra duration [s] of a step at the largest side speed; it is
        proportional to the side speed (Walk2014).
      left_calibration: ratio of the side step that is made to the requested one
        (Walk2014).
      lift_slope_left: foot lift added per metre of side step in a cycle of two steps
        [m/m] (Walk2014).
      outward_turn_share: share of a turn that the outer foot takes (Walk2014).
      timeout_periods: number of step periods after which a step ends even if the force
        sensors have not shown a change of the support foot (Walk2014).
      com_offset_speed_m_s: forward speed [m/s] at which the full value of the gait
        parameter com_offset_speed_gain is added to com_offset.
      posture_s: duration of crouching and of rising [s] (Walk2014).
      stretch: leg length when standing, as a share of the straight leg's; it puts the
        NAO's hips at 0.248 m as in Walk2014.
      shoulder_roll_rad: angle of the arms away from the body [rad] (Walk2014).
      speed_fraction: share of a motor's no-load speed that commands may use (Walk2014).
      gyro_filter_tick_s: sampling time [s] for which the gait parameter gyro_filter is
        given (Walk2014).
      sensor_start_n: initial scale [N] of a force sensor, which grows to its largest
        reading; 0.1 in Walk2014, whose sensors' unit is the weight of 1 kg.
      sensor_full_n: largest scale [N] of a force sensor; 5.0 of that unit in Walk2014.

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
        """Convert the constants for the NAO to those for a robot of another size."""
        changes = {}
        for field in fields(self):
            ends = (end for end in _UNITS if field.name.endswith(end))
            factor = scale.of(_UNITS.get(next(ends, ""), "1"))
            changes[field.name] = getattr(self, field.name) * factor
        return replace(self, **changes)


WALK2014_CONFIG = EngineConfig()
"""The walk engine's constants for the NAO, as in the rUNSWift 2014 code release."""
