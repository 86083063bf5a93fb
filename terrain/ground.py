"""Base class of all families of terrain: bounded parameters, extent and flat start."""

import dataclasses
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from groundwalk.json_data import is_number, is_whole
from terrain.heightfield import Heightfield

Parameter = float | int | tuple[float, float]
T = TypeVar("T", float, int, tuple[float, float])


def bounded(default: T, low: float, high: float) -> T:
    """Declare a dataclass field with a default and inclusive bounds.

    The default's type decides which values `checked` accepts for the field: a whole
    number (int), any number (float), or two increasing numbers (tuple).
    """
    return dataclasses.field(default=default, metadata={"bounds": (low, high)})


def checked(field: dataclasses.Field[Any], value: Any) -> Parameter:
    """Convert a value to the type of a field declared with `bounded`, or refuse it."""
    low, high = field.metadata["bounds"]
    span = f"from {low:g} to {high:g}, not {value!r}"
    if isinstance(field.default, tuple):
        pair = tuple(value) if isinstance(value, tuple | list) else ()
        are_two = len(pair) == 2 and all(map(is_number, pair))
        if not (are_two and low <= pair[0] < pair[1] <= high):
            raise BadValueError(f"{field.name} must be two increasing numbers {span}")
        return float(pair[0]), float(pair[1])
    if isinstance(field.default, int):
        if not is_whole(value) or not low <= value <= high:
            raise BadValueError(f"{field.name} must be a whole number {span}")
        return int(value)
    if not is_number(value) or not low <= value <= high:
        raise BadValueError(f"{field.name} must be a number {span}")
    return float(value)


MOST_SAMPLES = 1_000_000
"""Largest number of height samples of one ground. PyBullet 3.2.7 silently loads nothing
from 2^21 samples on; half of that keeps a safe distance."""


Seed = int | np.random.SeedSequence
Parameters = Callable[[float, float], Mapping[str, float]]


@dataclass(frozen=True)
class Ladder:
    """A quantity that makes ground hard to walk on, with its mildest and hardest value.

    Attributes:
      quantity: its name, such as "step height".
      unit: "m", "rad" or "1".
      mildest: mildest value; if the unit is "m", as a share of the robot's leg length.
      hardest: hardest value, given like `mildest`; the smaller one for friction.
      parameters: gives the terrain's parameters from a value of the quantity (SI units)
        and the robot's leg length [m].
    """

    quantity: str
    unit: str
    mildest: float
    hardest: float
    parameters: Parameters = lambda severity, leg_m: {}

    def severities(self, rungs: int, leg_m: float) -> FloatArray:
        """(rungs,) values in SI units, mildest first, in equal ratios."""
        scale = leg_m if self.unit == "m" else 1.0
        return np.geomspace(self.mildest * scale, self.hardest * scale, rungs)


@dataclass(frozen=True, kw_only=True)
class Ground(ABC):
    """Base of all families of terrain: a rectangle of ground, flat where robots start.

    Up to `start_radius_m` from the world's origin the height is 0; over the
    next `blend_m` the terrain fades in without a kink.

    Attributes:
      x_range_m: lowest and highest world x [m]; the grid reaches at least as far.
      y_range_m: lowest and highest world y [m]; the grid reaches at least as far.
      spacing_m: distance between the grid's samples [m].
      start_radius_m: radius of the flat start area [m].
      blend_m: width of the transition from flat ground to the terrain [m].
      ladders: for the terrain-stress command: ways to make this ground harder step by
        step, by name; empty for ground that it does not use.

    Example:
      >>> Waves(amplitude_m=0.02).make(seed=0).x_range_m
      (-1.0, 5.0)
    """

    ladders: ClassVar[dict[str, Ladder]] = {}

    x_range_m: tuple[float, float] = bounded((-1.0, 5.0), -1000.0, 1000.0)
    y_range_m: tuple[float, float] = bounded((-2.0, 2.0), -1000.0, 1000.0)
    spacing_m: float = bounded(0.025, 0.002, 1.0)
    start_radius_m: float = bounded(0.35, 0.0, 100.0)
    blend_m: float = bounded(0.25, 0.01, 100.0)

    def __post_init__(self) -> None:
        """Check every parameter, and turn it into a plain Python number."""
        for field in dataclasses.fields(self):
            value = checked(field, getattr(self, field.name))
            object.__setattr__(self, field.name, value)
        for name in ("x_range_m", "y_range_m"):
            low, high = getattr(self, name)
            if not low <= 0.0 <= high:
                raise BadValueError(
                    f"{name} must hold 0, where robots start, not {(low, high)}"
                )
        rows, columns = self._samples(self.y_range_m), self._samples(self.x_range_m)
        if rows * columns > MOST_SAMPLES:
            raise BadValueError(
                f"{rows} x {columns} samples are too many, {MOST_SAMPLES} are allowed: "
                "shrink x_range_m and y_range_m, or widen spacing_m"
            )

    @abstractmethod
    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] at world x (1, columns) and y (rows, 1) [m].

        They are flat where robots start; all randomness comes from the generator.
        """

    def make(self, seed: Seed) -> Heightfield:
        """Make the heightfield; the same seed makes the same bits every time."""
        if not isinstance(seed, np.random.SeedSequence):
            seed = np.random.SeedSequence(checked_seed(seed))
        generator = np.random.Generator(np.random.PCG64(seed))
        x_m, y_m = self._line(self.x_range_m), self._line(self.y_range_m)
        heights_m = self.heights(x_m[None, :], y_m[:, None], generator)
        origin_m = (self.x_range_m[0], self.y_range_m[0])
        return Heightfield(heights_m, origin_m, self.spacing_m)

    def past_start(self, distance_m: FloatArray) -> FloatArray:
        """Factor from 0 to 1 for the terrain's heights that leaves the start area flat.

        By distance from the world's origin [m] (any shape): 0 up to `start_radius_m`, 1
        from `blend_m` further on, between them the cubic t^2 (3 - 2 t), t = 0 to 1.
        """
        t = np.clip((distance_m - self.start_radius_m) / self.blend_m, 0.0, 1.0)
        return t * t * (3.0 - 2.0 * t)

    def _require_spacings(self, name: str, least: int) -> None:
        """Refuse the length parameter `name` if it is below `least` grid spacings."""
        length_m, least_m = getattr(self, name), least * self.spacing_m
        if length_m < least_m:
            raise BadValueError(
                f"{name} must be at least {least} spacings = {least_m:g}, "
                f"not {length_m:g}"
            )

    def _line(self, range_m: tuple[float, float]) -> FloatArray:
        """Coordinates [m] of the grid's samples that cover a range along one axis."""
        return range_m[0] + self.spacing_m * np.arange(
            self._samples(range_m), dtype=np.float64
        )

    def _samples(self, range_m: tuple[float, float]) -> int:
        """Number of grid samples, 2 or more, that cover a range [m] along one axis."""
        cells = math.ceil((range_m[1] - range_m[0]) / self.spacing_m - 1e-6)
        return max(cells, 1) + 1


def checked_seed(seed: object) -> int:
    """Convert a seed to an int; BadValueError unless it is a whole number >= 0."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise BadValueError(f"seed must be a whole number of 0 or more, not {seed!r}")
    return int(seed)
