"""Terrain: regular sine waves."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from groundwalk.arrays import FloatArray
from terrain.bounds import bounded
from terrain.ground import Ground
from terrain.ladder import Ladder


@dataclass(frozen=True, kw_only=True)
class Waves(Ground):
    """Terrain of sine waves with a zero at the origin, the same for every seed.

    Attributes:
      amplitude_m: height of the crests and depth of the troughs [m].
      wavelength_m: distance from crest to crest [m]; at least 4 grid spacings.
      heading_rad: direction from crest to crest, seen from above, from +x to the left
        [rad]; at 0 the crests lie across the walking direction.

    Example:
      >>> Waves(amplitude_m=0.02, wavelength_m=0.5).make(seed=0).heights_m.max() <= 0.02
      True
    """

    ladders: ClassVar[Mapping[str, Ladder]] = MappingProxyType(
        {
            "waves": Ladder(
                "amplitude",
                "m",
                0.008,
                0.12,
                lambda height_m, leg_m: {
                    "amplitude_m": height_m,
                    "wavelength_m": 1.6 * leg_m,
                },
            )
        }
    )

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
