"""Ladders of severity: how a stress test makes a kind of ground harder in steps."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray

Parameters = Callable[[float, float], Mapping[str, float]]


@dataclass(frozen=True)
class Ladder:
    """One quantity that makes ground hard to walk on, from its mildest value up.

    Attributes:
      quantity: its name, such as "step height".
      unit: "m", "rad" or "1".
      mildest: first value of the ladder; if the unit is m, a share of the leg's length.
      hardest: last value, in the unit of `mildest`; the smaller number for quantities
        such as friction.
      parameters: function of a severity in SI units and the length of the robot's
        legs [m] that returns the ground's parameters.
    """

    quantity: str
    unit: str
    mildest: float
    hardest: float
    parameters: Parameters = lambda severity, leg_m: {}

    def severities(self, rungs: int, leg_m: float) -> FloatArray:
        """(rungs,) severities in SI units from the mildest on, in equal ratios."""
        scale = leg_m if self.unit == "m" else 1.0
        return np.geomspace(self.mildest * scale, self.hardest * scale, rungs)
