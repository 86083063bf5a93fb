"""Regular waves."""

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
    """Sine waves with their zero at the origin; no seed makes a difference.

    Attributes:
      amplitude_m: height of the crests, depth of the troughs [m].
      wavelength_m: distance from crest to crest [m]; at least 4 spacings.
      heading_rad: direction in which the waves follow each other, seen from
        above, from +x to the left [rad]; 0: crests lie across the way.
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
        """Check that the grid can carry the waves."""
        super().__post_init__()
        self._require_spacings("wavelength_m", 4)

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Sine waves; see `Ground.heights`."""
        along_m = math.cos(self.heading_rad) * x_m + math.sin(self.heading_rad) * y_m
        wave = np.sin(2.0 * math.pi / self.wavelength_m * along_m)
        return self.past_start(np.hypot(x_m, y_m)) * self.amplitude_m * wave
