"""Terrain: stairs across the walking direction."""

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

    ladders: ClassVar[Mapping[str, Ladder]] = MappingProxyType(
        {
            "stairs": Ladder(
                "step height",
                "m",
                0.008,
                0.1,
                lambda height_m, leg_m: {"step_m": height_m, "tread_m": 1.2 * leg_m},
            )
        }
    )

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
