"""Constants of the walk engine that are the same for all gaits."""

import math
from dataclasses import dataclass, fields, replace

from robots.scale import Scale

STANDARD_GRAVITY_M_S2 = 9.80665

_UNITS = {"_m_s": "m/s", "_rad_s": "rad/s", "_s": "s", "_n": "N"}
"""Units of the attributes of `EngineConfig` by the end of their names; attributes with
other names are not scaled with a robot's size."""


@dataclass(frozen=True)
class EngineConfig:
    """Constants of the walk engine that are the same for all gaits, sized for the NAO.

    The values are those of the rUNSWift 2014 code release (Walk2014), except for
    com_offset_speed_m_s.

    Attributes:
      max_left_m_s: largest speed to the side.
      max_turn_rad_s: largest rate of turn.
      side_step_extra_s: extra duration of a step at the largest side speed; it is
        proportional to the side speed.
      left_calibration: ratio of the side step that is made to the requested one.
      lift_slope_left: foot lift per metre of side step in a cycle of two steps [m/m].
      outward_turn_share: share of a turn that the outer foot takes.
      timeout_periods: number of step periods after which a step ends even if the force
        sensors have not shown a change of the support foot.
      com_offset_speed_m_s: forward speed at which the full value of the gait parameter
        com_offset_speed_gain is added to com_offset.
      posture_s: duration of crouching and of rising.
      stretch: leg length when standing, as a share of the straight leg's; it puts the
        NAO's hips at 0.248 m.
      shoulder_roll_rad: angle of the arms away from the body.
      speed_fraction: share of a motor's no-load speed that commands may use.
      gyro_filter_tick_s: sampling time for which the gait parameter gyro_filter holds.
      sensor_start_n: initial scale of a force sensor, which grows to its largest
        reading; Walk2014's unit is the weight of 1 kg.
      sensor_full_n: largest scale of a force sensor.
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

    def scaled(self, scale: Scale) -> "EngineConfig":
        """Convert the constants for the NAO to those for a robot of another size."""
        changes = {}
        for field in fields(self):
            ends = (end for end in _UNITS if field.name.endswith(end))
            factor = scale.of(_UNITS.get(next(ends, ""), "1"))
            changes[field.name] = getattr(self, field.name) * factor
        return replace(self, **changes)
