"""The table of the 16 parameters of a gait: units, bounds, meaning, source.

"Walk2014" is the walk of B. Hengst, rUNSWift Walk2014, UNSW report 2014, and the
gait generator in the team's 2014 code release; "rUNSWift 2022", "B-Human" and "HULKs"
are later published walks derived from it. Each parameter affects straight walking.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """One of the 16 parameters of a gait.

    Attributes:
      name: its name in a `Gait` and in JSON.
      unit: SI unit, "1" for a plain number.
      default: the value of Walk2014, or the value that leaves Walk2014 unchanged.
      low: smallest value that a gait may have.
      high: largest value that a gait may have.
      meaning: its effect on the walk.
      source: origin of the default and the bounds.

    Example:
      >>> PARAMETERS[0].name, PARAMETERS[0].unit
      ('step_period', 's')
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    meaning: str
    source: str


PARAMETERS: tuple[Parameter, ...] = (
    Parameter(
        *("step_period", "s", 0.23, 0.16, 0.34),
        meaning="duration of one step without side step, half a cycle",
        source="Walk2014; descendants 0.235 to 0.25; below 0.18 the knee is too slow",
    ),
    Parameter(
        *("hip_height", "m", 0.230, 0.200, 0.240),
        meaning="height of the hip above the sole while walking",
        source="Walk2014, which says that 0.20 to 0.235 works; bounded by reach",
    ),
    Parameter(
        *("max_forward", "m/s", 0.30, 0.05, 0.45),
        meaning="largest forward and backward speed that is carried out",
        source="Walk2014; fastest published about 0.34",
    ),
    Parameter(
        *("com_offset", "m", 0.010, -0.010, 0.035),
        meaning="how far the hip is ahead of the middle of the two ankles",
        source="Walk2014; up to 0.022 in rUNSWift 2022",
    ),
    Parameter(
        *("com_offset_speed_gain", "m", 0.0, -0.010, 0.030),
        meaning="added to com_offset at 0.3 m/s, in proportion to the speed",
        source="0.012 in rUNSWift 2022; Walk2014 has none",
    ),
    Parameter(
        *("base_leg_lift", "m", 0.010, 0.004, 0.040),
        meaning="height to which the swing foot is lifted at speed 0",
        source="Walk2014; 0.008 to 0.015 in use, uneven ground needs more",
    ),
    Parameter(
        *("lift_slope_forward", "m/m", 0.01, 0.0, 0.15),
        meaning="lift added for every metre that a cycle of two steps covers",
        source="Walk2014",
    ),
    Parameter(
        *("lift_apex_phase", "1", 0.50, 0.30, 0.70),
        meaning="part of the step after which the swing foot is highest",
        source="Walk2014; 0.45 to 0.8 in HULKs, 0.5 in B-Human",
    ),
    Parameter(
        *("swing_dead_fraction", "1", 0.0, 0.0, 0.5),
        meaning="part of the step in which the swing foot does not travel",
        source="Walk2014 sagittally; 0.1 laterally, 0.2 in rUNSWift 2022",
    ),
    Parameter(
        *("start_lift_divisor", "1", 3.5, 1.2, 6.0),
        meaning="the lift of the first step is divided by this",
        source="Walk2014",
    ),
    Parameter(
        *("arm_swing", "rad/m", 6.0, 0.0, 14.0),
        meaning="shoulder pitch for every metre between foot and hip",
        source="Walk2014; 8 in HULKs",
    ),
    Parameter(
        *("gyro_sagittal", "s", 0.040, 0.0, 0.15),
        meaning="support ankle pitch for every rad/s of the torso's pitch rate",
        source="Walk2014; 0.05 to 0.07 later, 0.1 on worn robots",
    ),
    Parameter(
        *("gyro_filter", "1", 0.20, 0.05, 0.90),
        meaning="weight of a new gyroscope sample in the low-pass filter, at 100 Hz",
        source="Walk2014; 0.4 in B-Human",
    ),
    Parameter(
        *("gyro_coronal", "s", 0.0, 0.0, 0.12),
        meaning="support ankle roll for every rad/s of the torso's roll rate",
        source="off in Walk2014 while walking; 0.03 to 0.05 in B-Human",
    ),
    Parameter(
        *("switch_min_phase", "1", 0.75, 0.40, 0.95),
        meaning="part of the step before which the support foot does not change",
        source="Walk2014; 0.5 in rUNSWift 2022 and B-Human",
    ),
    Parameter(
        *("torso_pitch", "rad", 0.0, -0.06, 0.12),
        meaning="forward lean of the torso while the soles stay level",
        source="none in Walk2014; 0.025 and 0.055 in HULKs",
    ),
)
"""The 16 parameters of a gait, in the order of the values in a gait's vector.

Example:
  >>> PARAMETERS[0].name
  'step_period'
"""

NAMES: tuple[str, ...] = tuple(parameter.name for parameter in PARAMETERS)
"""Names of the 16 gait parameters, in the order of `PARAMETERS`."""
