"""Terrain: round bumps at random places of flat ground."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from groundwalk.arrays import FloatArray
from terrain.bounds import bounded
from terrain.ground import Ground, Ladder


@dataclass(frozen=True, kw_only=True)
class Bumps(Ground):
    """Terrain of round bumps at random places, with flat ground between them.

    The centres are a Poisson process over the ground. A bump of height h is
    h (1 - (r / radius_m)^2)^2 at distance r from its centre: level at its top and
    at its foot. Where bumps overlap the higher one counts: no point is lower
    than 0 or higher than `height_m`.

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
