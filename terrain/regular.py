"""Terrains without randomness: flat, a tilted plane, stairs and sine waves."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from groundwalk.arrays import FloatArray
from terrain.ground import Ground, Ladder, bounded


@dataclass(frozen=True, kw_only=True)
class Flat(Ground):
    """Terrain of level ground at height 0, the same for every seed.

    Example:
      >>> Flat(x_range_m=(-1.0, 9.0)).make(seed=0).is_flat
      True
    """

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m], all zero, at x (1, columns), y (rows, 1)."""
        return np.zeros((y_m.size, x_m.size))


def _ladder(heading_rad: float) -> Ladder:
    """Ladder of slopes of 1.7 to 14 degrees that climb in one direction [rad]."""
    return Ladder(
        *("angle", "rad", 0.03, 0.25),
        lambda angle_rad, leg_m: {"angle_rad": angle_rad, "heading_rad": heading_rad},
    )


@dataclass(frozen=True, kw_only=True)
class Slope(Ground):
    """Terrain of a tilted plane that begins in front of the robot's start area.

    With c and s the cosine and sine of `heading_rad`, r = `start_radius_m` and
    b = `blend_m`, the height from x = r + b on is tan(angle) (c (x - r - b / 2) + s y).
    Up to x = r the ground is flat; from there to r + b the gradient grows continuously.

    Attributes:
      angle_rad: steepness [rad].
      heading_rad: direction in which the ground climbs, from +x to the left [rad]: 0 is
        uphill, pi downhill, pi / 2 climbs to the left.

    Example:
      >>> Slope(angle_rad=0.1, heading_rad=math.pi).make(seed=0).height_at(5, 0) < 0
      True
    """

    ladders: ClassVar[dict[str, Ladder]] = {
        "slope_up": _ladder(0.0),
        "slope_down": _ladder(math.pi),
        "slope_side": _ladder(math.pi / 2),
    }

    angle_rad: float = bounded(math.radians(5.0), 0.0, 0.7)
    heading_rad: float = bounded(0.0, -2.0 * math.pi, 2.0 * math.pi)

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] of the plane at x (1, columns), y (rows, 1)."""
        beyond_m = x_m - self.start_radius_m
        within_m = np.clip(beyond_m, 0.0, self.blend_m)
        # The integral of a gradient that grows linearly over the blend.
        level_m = np.maximum(beyond_m - self.blend_m, 0.0)
        forward_m = within_m**2 / (2.0 * self.blend_m) + level_m
        sideways_m = self.past_start(x_m) * y_m
        cosine, sine = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return math.tan(self.angle_rad) * (cosine * forward_m + sine * sideways_m)


@dataclass(frozen=True, kw_only=True)
class Stairs(Ground):
    """Terrain of equal steps along x, the first at x = `start_radius_m`.

    Each step rises within one grid cell, because the surface joins the samples by
    triangles. After the last step the ground stays level. `blend_m` has no effect.

    Attributes:
      step_m: height of a step [m]; below 0 the stairs lead down.
      tread_m: distance from one riser to the next [m]; at least 2 grid spacings.
      steps: number of steps.

    Example:
      >>> Stairs(step_m=0.02, steps=3).make(seed=0).height_at(4.0, 0.0)
      array(0.06)
    """

    ladders: ClassVar[dict[str, Ladder]] = {
        "stairs": Ladder(
            *("step height", "m", 0.008, 0.1),
            lambda height_m, leg_m: {"step_m": height_m, "tread_m": 1.2 * leg_m},
        )
    }

    step_m: float = bounded(0.01, -0.5, 0.5)
    tread_m: float = bounded(0.3, 0.01, 100.0)
    steps: int = bounded(5, 1, 1000)

    def __post_init__(self) -> None:
        """Check that there is a level part between two risers."""
        super().__post_init__()
        self._require_spacings("tread_m", 2)

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] of the steps at x (1, columns), y (rows, 1)."""
        treads = (x_m - self.start_radius_m) / self.tread_m
        # A sample on an edge belongs to the lower tread, whatever its rounding.
        climbed = np.clip(np.ceil(treads - 1e-9), 0, self.steps)
        return np.repeat(self.step_m * climbed, y_m.size, axis=0)


@dataclass(frozen=True, kw_only=True)
class Waves(Ground):
    """Terrain of sine waves with a zero at the origin, the same for every seed.

    Attributes:
      amplitude_m: height of the crests and depth of the troughs [m].
      wavelength_m: distance from crest to crest [m]; at least 4 grid spacings.
      heading_rad: direction from crest to crest, from +x to the left [rad].

    Example:
      >>> Waves(amplitude_m=0.02, wavelength_m=0.5).make(seed=0).heights_m.max() <= 0.02
      True
    """

    ladders: ClassVar[dict[str, Ladder]] = {
        "waves": Ladder(
            *("amplitude", "m", 0.008, 0.12),
            lambda top_m, leg_m: {"amplitude_m": top_m, "wavelength_m": 1.6 * leg_m},
        )
    }

    amplitude_m: float = bounded(0.01, 0.0, 0.5)
    wavelength_m: float = bounded(0.4, 0.01, 100.0)
    heading_rad: float = bounded(0.0, -2.0 * math.pi, 2.0 * math.pi)

    def __post_init__(self) -> None:
        """Check that the grid is fine enough for the waves."""
        super().__post_init__()
        self._require_spacings("wavelength_m", 4)

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] of the waves at x (1, columns), y (rows, 1)."""
        along_m = math.cos(self.heading_rad) * x_m + math.sin(self.heading_rad) * y_m
        wave = np.sin(2.0 * math.pi / self.wavelength_m * along_m)
        return self.past_start(np.hypot(x_m, y_m)) * self.amplitude_m * wave
