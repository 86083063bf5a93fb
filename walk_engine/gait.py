"""A gait: one value for each of the 16 parameters of the walk engine."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, GroundwalkError, UnknownNameError
from groundwalk.files import write_text
from walk_engine.parameters import NAMES, PARAMETERS, Parameter

__all__ = ["NAMES", "PARAMETERS", "Gait", "Parameter", "from_unit", "stack", "to_unit"]

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
        """Make a gait from an array (16,) of its values in the order of `PARAMETERS`.

        Raises:
          BadValueError: the number of values is wrong or a value is out of bounds; the
            message names the first such parameter.
        """
        values = np.asarray(vector, dtype=np.float64)
        if values.ndim != 1:
            raise BadValueError(f"a gait vector has 1 axis, {values.ndim} were given")
        return cls(tuple(values.tolist()))

    @classmethod
    def from_mapping(cls, values: Mapping[str, float]) -> "Gait":
        """Make a gait from the values of all parameters, by name.

        Raises:
          UnknownNameError: no parameter has one of the names.
          BadValueError: a parameter is missing, not a number or out of bounds.
        """
        for name in values:
            if name not in NAMES:
                raise UnknownNameError("gait parameter", name, NAMES)
        missing = [name for name in NAMES if name not in values]
        if missing:
            raise BadValueError(f"the gait lacks {', '.join(missing)}")
        return cls(tuple(values[name] for name in NAMES))

    @classmethod
    def load(cls, path: Path) -> "Gait":
        """Read a gait from a JSON file: `{"gait": {name: value}}` or `{name: value}`.

        Raises:
          BadValueError: the file cannot be read or holds no gait; the message says why.
        """
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
    """Put n gaits, or rows of values to be checked, into one (n, 16) array.

    Raises:
      BadValueError: no gait is given, or a value is out of bounds.
    """
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
