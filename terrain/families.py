"""All families of terrain: flat, slope, stairs, waves, and random bumps and lumps."""

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
    """Severities for stress tests: slopes of 1.7 to 14 degrees in a heading [rad]."""
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


@dataclass(frozen=True, kw_only=True)
class Bumps(Ground):
    """Terrain of round bumps at random places, with flat ground between them.

    The centres are a Poisson process over the ground. A bump of height h is
    h (1 - (r / radius_m)^2)^2 at distance r from its centre. Where bumps overlap the
    higher one counts.

    Attributes:
      height_m: largest height of a bump [m]; heights are uniform from 0 to this.
      radius_m: radius of every bump [m]; at least 2 grid spacings.
      density_per_m2: mean number of bumps on a square metre.

    Example:
      >>> Bumps(height_m=0.03).make(seed=1).heights_m.max() <= 0.03
      True
    """

    ladders: ClassVar[dict[str, Ladder]] = {
        "bumps": Ladder(
            *("height", "m", 0.016, 0.16),
            lambda height_m, leg_m: {
                "height_m": height_m,
                "radius_m": 0.32 * leg_m,
                "density_per_m2": 2.5 / leg_m**2,
            },
        )
    }

    height_m: float = bounded(0.015, 0.0, 0.5)
    radius_m: float = bounded(0.08, 0.01, 10.0)
    density_per_m2: float = bounded(40.0, 0.0, 1000.0)

    def __post_init__(self) -> None:
        """Check that a bump is wide enough to show on the grid of samples."""
        super().__post_init__()
        self._require_spacings("radius_m", 2)

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] of round bumps at x (1, columns), y (rows, 1)."""
        columns_m, rows_m = x_m[0], y_m[:, 0]
        area_m2 = float(np.ptp(columns_m) * np.ptp(rows_m))
        count = generator.poisson(self.density_per_m2 * area_m2)
        centre_x_m = generator.uniform(columns_m[0], columns_m[-1], count)
        centre_y_m = generator.uniform(rows_m[0], rows_m[-1], count)
        top_m = generator.uniform(0.0, self.height_m, count)
        heights_m = np.zeros((rows_m.size, columns_m.size))
        for x, y, top in zip(centre_x_m, centre_y_m, top_m, strict=True):
            column, row = self._near(columns_m, x), self._near(rows_m, y)
            squared = (columns_m[column] - x) ** 2 + (rows_m[row, None] - y) ** 2
            fall = np.maximum(1.0 - squared / self.radius_m**2, 0.0)
            patch = heights_m[row, column]
            np.maximum(patch, top * fall**2, out=patch)
        return self.past_start(np.hypot(x_m, y_m)) * heights_m

    def _near(self, samples_m: FloatArray, centre_m: float) -> slice:
        """Indices of the samples along one axis that a bump at a centre can raise."""
        reach = math.ceil(self.radius_m / self.spacing_m)
        middle = round((centre_m - float(samples_m[0])) / self.spacing_m)
        return slice(max(middle - reach, 0), middle + reach + 1)


WAVES = 256  # plane waves in the sum; heights are then Gaussian: kurtosis -1.5 / 256
DEVIATIONS_WITHIN_99_PERCENT = 2.5758293035489004  # +- these hold 99 % of a Gaussian


@dataclass(frozen=True, kw_only=True)
class Lumps(Ground):
    """Terrain of smooth lumps: a Gaussian random field of wavelengths in one octave.

    The field is the sum of 256 plane waves of equal amplitude with random directions,
    phases and wave numbers (the spectral representation of a random field: Shinozuka
    and Jan, Journal of Sound and Vibration 25, 1972). It is a function of x and y, not
    of the grid: a seed gives the same lumps at any extent and spacing.

    The defaults are as hard as the foam under turf of the SGAT paper (section on the
    NAO: 14.66 cm/s, always falls): the gait of the rUNSWift 2014 release (Walk2014) is
    about as slow on them and mostly falls on a course of 3 m (docs/results/walk), while
    a gait with higher steps and more gyroscope feedback can walk there.

    Attributes:
      amplitude_m: 99 % of the ground lies within plus or minus this height [m];
        the rms height is amplitude_m / 2.576.
      wavelength_m: the middle of the octave [m], at least 4 grid spacings; wavelengths
        are uniform in their logarithm.

    Example:
      >>> ground = Lumps(amplitude_m=0.012).make(seed=7)
    """

    ladders: ClassVar[dict[str, Ladder]] = {
        "lumps": Ladder(
            *("amplitude", "m", 0.008, 0.08),
            lambda top_m, leg_m: {"amplitude_m": top_m, "wavelength_m": 0.8 * leg_m},
        )
    }

    amplitude_m: float = bounded(0.008, 0.0, 0.5)
    wavelength_m: float = bounded(0.2, 0.01, 100.0)

    def __post_init__(self) -> None:
        """Check that the grid is fine enough for the shortest waves."""
        super().__post_init__()
        self._require_spacings("wavelength_m", 4)

    @property
    def rms_m(self) -> float:
        """Root mean square of the heights [m] outside of the flat start area."""
        return self.amplitude_m / DEVIATIONS_WITHIN_99_PERCENT

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] of the lumps at x (1, columns), y (rows, 1)."""
        octave = generator.uniform(-0.5, 0.5, WAVES)
        direction_rad = generator.uniform(0.0, 2.0 * math.pi, WAVES)
        phase_rad = generator.uniform(0.0, 2.0 * math.pi, WAVES)
        wave_number = 2.0 * math.pi / self.wavelength_m * 2.0**octave
        along_x = np.outer(wave_number * np.cos(direction_rad), x_m)
        along_y = np.outer(wave_number * np.sin(direction_rad), y_m)
        along_y += phase_rad[:, np.newaxis]
        # cos(a + b) = cos a cos b - sin a sin b saves one cosine per wave and sample;
        # einsum, because the bits of a BLAS product may depend on the threads of BLAS.
        waves: FloatArray = np.einsum("ky,kx->yx", np.cos(along_y), np.cos(along_x))
        waves -= np.einsum("ky,kx->yx", np.sin(along_y), np.sin(along_x))
        shown = self.past_start(np.hypot(x_m, y_m))
        return shown * (self.rms_m * math.sqrt(2.0 / WAVES)) * waves
