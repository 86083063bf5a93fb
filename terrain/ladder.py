"""Ladders of severity: steps in which terrain-stress makes a kind of ground harder."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray

Parameters = Callable[[float, float], Mapping[str, float]]


@dataclass(frozen=True)
class Ladder:
    """A quantity that makes ground hard to walk on, with its mildest and hardest value.

    Attributes:
      quantity: the quantity's name, such as "step height".
      unit: the quantity's unit: "m", "rad" or "1".
      mildest: mildest value; if the unit is "m", as a share of the robot's leg length.
      hardest: hardest value, given like `mildest`; smaller than it for quantities such
        as friction.
      parameters: function of a value of the quantity (SI units) and the robot's leg
        length [m] that returns the parameters of the terrain.
    """

    quantity: str
    unit: str
    mildest: float
    hardest: float
    parameters: Parameters = lambda severity, leg_m: {}

    def severities(self, rungs: int, leg_m: float) -> FloatArray:
        """(rungs,) values of the quantity in SI units, mildest first, in equal ratios.

        Args:
          rungs: number of values.
          leg_m: length of the robot's legs [m].
        """
        scale = leg_m if self.unit == "m" else 1.0
        return np.geomspace(self.mildest * scale, self.hardest * scale, rungs)
