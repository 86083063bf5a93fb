"""Errors of the nominal and the corrected sim on held-out recordings."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from groundwalk.json_data import check_number


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Rms errors of simulations on held-out recordings; None if not computed.

    `without`, `wrong_place` and `wrong_effect` show the error of wrong answers; there,
    the main effect is the found effect that reduces the error most.

    Attributes:
      nominal: error of the nominal sim.
      corrected: error of the sim with the effects found.
      floor: noise floor: the measured noise, or the accuracy of simulation and clocks
        where that is larger.
      ceiling: error of a flexible regression without physics.
      without: error without the main effect, the others refitted.
      wrong_place: error with the main effect moved to the best other place.
      wrong_effect: error with the main effect replaced by one drawn at random.

    Example:
      >>> Errors(nominal=5.0, corrected=1.2, floor=1.0).closed(1.2)
      0.95
    """

    nominal: float
    corrected: float
    floor: float
    ceiling: float | None = None
    without: float | None = None
    wrong_place: float | None = None
    wrong_effect: float | None = None

    def __post_init__(self) -> None:
        """Refuse negative errors."""
        for name in Errors.__dataclass_fields__:
            value = getattr(self, name)
            if value is not None:
                check_number(name, value, 0.0)

    @property
    def excess(self) -> float:
        """The error of the nominal sim as a multiple of the noise floor."""
        if self.floor > 0:
            return self.nominal / self.floor
        return math.inf if self.nominal > 0 else 0.0

    def closed(self, error: float | None) -> float | None:
        """Share of the nominal sim's error above the noise floor that is removed.

        It is 1 if the error that remains is down to the floor, 0 if it is the nominal
        sim's; None if that is no worse than the noise, or `error` is None.
        """
        if error is None or self.nominal <= self.floor:
            return None
        return (self.nominal - error) / (self.nominal - self.floor)


@dataclass(frozen=True, kw_only=True)
class ChannelFit(Errors):
    """Rms errors of simulations in one channel of held-out recordings."""

    unit: str


@dataclass(frozen=True, kw_only=True)
class Fit(Errors):
    """Errors of simulations over all channels together, as multiples of noise floors.

    An error is the root of the mean over channels of (rms error / noise floor) squared.
    """

    channels: Mapping[str, ChannelFit]
