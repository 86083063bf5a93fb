"""A gait: one value for each of the 16 parameters of the walk engine.

"Walk2014" is the walk of B. Hengst, rUNSWift Walk2014, UNSW report 2014, and the
gait generator in the team's 2014 code release; "rUNSWift 2022", "B-Human" and "HULKs"
are later published walks derived from it.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, GroundwalkError, UnknownNameError
from groundwalk.files import write_text


@dataclass(frozen=True)
class Parameter:
    """One of the 16 parameters of a gait.

    Attributes:
      name: its name in a `Gait` and in JSON.
      unit: SI unit, "1" for a plain number.
      default: the value of Walk2014, or the value that leaves Walk2014 unchanged.
      low, high: smallest and largest value that a gait may have.
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
  >>> PARAMETERS[0].name, PARAMETERS[0].unit
  ('step_period', 's')
"""

NAMES: tuple[str, ...] = tuple(parameter.name for parameter in PARAMETERS)
"""Names of the 16 gait parameters, in the order of `PARAMETERS`."""


_LOW = np.array([parameter.low for parameter in PARAMETERS])
_HIGH = np.array([parameter.high for parameter in PARAMETERS])


@dataclass(frozen=True)
class Gait(Mapping[str, float]):
    """Values of the 16 walk-engine parameters: an immutable mapping from their names.

    Every gait is complete and within the bounds that `PARAMETERS` lists.

    Attributes:
      vector: the 16 values in the order of `PARAMETERS`.

    Example:
      >>> gait = gaits.get("start").replace(max_forward=0.2)
      >>> gait["max_forward"]
      0.2
    """

    vector: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse a wrong number of values and values out of bounds."""
        if len(self.vector) != len(PARAMETERS):
            raise BadValueError(
                f"a gait has {len(PARAMETERS)} values, {len(self.vector)} were given"
            )
        values = tuple(map(_checked, PARAMETERS, self.vector))
        object.__setattr__(self, "vector", values)

    @classmethod
    def from_vector(cls, vector: npt.ArrayLike) -> "Gait":
        """Make a gait from an array (16,) of values in the order of `PARAMETERS`."""
        values = np.asarray(vector, dtype=np.float64)
        if values.ndim != 1:
            raise BadValueError(f"a gait vector has 1 axis, {values.ndim} were given")
        return cls(tuple(values.tolist()))

    @classmethod
    def from_mapping(cls, values: Mapping[str, float]) -> "Gait":
        """Make a gait from the values of all parameters, by name."""
        for name in values:
            if name not in NAMES:
                raise UnknownNameError("gait parameter", name, NAMES)
        missing = [name for name in NAMES if name not in values]
        if missing:
            raise BadValueError(f"the gait lacks {', '.join(missing)}")
        return cls(tuple(values[name] for name in NAMES))

    @classmethod
    def load(cls, path: Path) -> "Gait":
        """Read a JSON file with `{"gait": {name: value}}` or `{name: value}`."""
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise BadValueError(f"{path} is no gait file: {error}") from error
        values = content.get("gait", content) if isinstance(content, dict) else content
        if not isinstance(values, dict):
            raise BadValueError(f"{path} is no gait file: it must map names to values")
        try:
            return cls.from_mapping(values)
        except GroundwalkError as error:
            raise BadValueError(f"{path}: {error}") from error

    def save(self, path: Path) -> None:
        """Write the gait to a JSON file, which `Gait.load` reads back exactly."""
        write_text(path, json.dumps({"gait": dict(self)}, indent=2) + "\n")

    def to_vector(self) -> FloatArray:
        """The values as a new (16,) array in the order of `PARAMETERS`."""
        return np.array(self.vector)

    def replace(self, **changes: float) -> "Gait":
        """Copy the gait with other values of some parameters, given by name."""
        return Gait.from_mapping({**self, **changes})

    def __getitem__(self, name: str) -> float:
        """The value of a parameter; KeyError if no parameter has this name."""
        if name not in NAMES:
            raise KeyError(name)
        return self.vector[NAMES.index(name)]

    def __iter__(self) -> Iterator[str]:
        """The parameter names, in the order of `PARAMETERS`."""
        return iter(NAMES)

    def __len__(self) -> int:
        """The number of parameters, 16."""
        return len(NAMES)


def stack(gaits: Sequence[Gait] | FloatArray) -> FloatArray:
    """Put n gaits, or rows of values to be checked, into one (n, 16) array."""
    rows = [
        gait if isinstance(gait, Gait) else Gait.from_vector(gait) for gait in gaits
    ]
    if not rows:
        raise BadValueError("no gait was given; at least one is needed")
    return np.stack([gait.to_vector() for gait in rows])


def to_unit(vectors: npt.ArrayLike) -> FloatArray:
    """Scale gait vectors (..., 16) so that each parameter's bounds become 0 and 1."""
    units: FloatArray = (np.asarray(vectors, dtype=np.float64) - _LOW) / (_HIGH - _LOW)
    return units


def from_unit(units: npt.ArrayLike) -> FloatArray:
    """Scale values (..., 16) from [0, 1] to their bounds; BadValueError outside."""
    parts = np.asarray(units, dtype=np.float64)
    if not ((parts >= 0) & (parts <= 1)).all():
        raise BadValueError("scaled gait values must lie between 0 and 1")
    # Rounding may carry a value past its bound by the last bit.
    vectors: FloatArray = np.clip(_LOW + parts * (_HIGH - _LOW), _LOW, _HIGH)
    return vectors


def _checked(parameter: Parameter, value: float) -> float:
    """Convert a parameter's value to a float; refuse it unless it is within bounds."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not (is_number and parameter.low <= value <= parameter.high):
        raise BadValueError(
            f"gait parameter {parameter.name} is {value!r}; it must be "
            f"between {parameter.low:g} and {parameter.high:g} {parameter.unit}"
        )
    return float(value)
