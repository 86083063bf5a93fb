"""Terrain: a tilted plane, uphill, downhill or across the walking direction."""

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


def _ladder(heading_rad: float) -> Ladder:
    """Ladder of slopes of 1.7 to 14 degrees that climb in one direction.

    Args:
      heading_rad: direction of the climb, from world x to the left [rad].
    """
    return Ladder(
        "angle",
        "rad",
        0.03,
        0.25,
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
      heading_rad: direction in which the ground climbs, seen from above, from +x
        to the left [rad]: 0 is uphill, pi downhill, pi / 2 climbs to the left.

    Example:
      >>> Slope(angle_rad=0.1, heading_rad=math.pi).make(seed=0).height_at(5, 0) < 0
      True
    """

    ladders: ClassVar[Mapping[str, Ladder]] = MappingProxyType(
        {
            "slope_up": _ladder(0.0),
            "slope_down": _ladder(math.pi),
            "slope_side": _ladder(math.pi / 2),
        }
    )

    angle_rad: float = bounded(math.radians(5.0), 0.0, 0.7)
    heading_rad: float = bounded(0.0, -2.0 * math.pi, 2.0 * math.pi)

    def heights(
        self, x_m: FloatArray, y_m: FloatArray, generator: np.random.Generator
    ) -> FloatArray:
        """Heights (rows, columns) [m] of the plane at x (1, columns), y (rows, 1)."""
        beyond_m = x_m - self.start_radius_m
        within_m = np.clip(beyond_m, 0.0, self.blend_m)
        # The integral of a gradient that grows linearly over the blend.
        forward_m = within_m**2 / (2.0 * self.blend_m) + np.maximum(
            beyond_m - self.blend_m, 0.0
        )
        sideways_m = self.past_start(x_m) * y_m
        climb_m = (
            math.cos(self.heading_rad) * forward_m
            + math.sin(self.heading_rad) * sideways_m
        )
        return math.tan(self.angle_rad) * climb_m
