"""Errors of the nominal and the corrected sim on held-out recordings."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from groundwalk.json_data import check_number


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Rms errors on held-out recordings; None for those that were not computed.

    The last three are controls: they show what a wrong answer would have reached.

    Attributes:
      nominal: error of the nominal sim.
      corrected: error of the sim with the effects found.
      floor: noise floor: the measured noise, or the accuracy of simulation and clocks
        where that is larger.
      ceiling: error of a flexible regression without physics.
      without: error with the effect left out that closes most, the others refitted.
      wrong_place: error with that effect moved to the best other place.
      wrong_effect: error with that effect replaced by another one, drawn at random.

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
        """The nominal error in multiples of the floor."""
        if self.floor > 0:
            return self.nominal / self.floor
        return math.inf if self.nominal > 0 else 0.0

    def closed(self, error: float | None) -> float | None:
        """Share of the nominal error above the noise floor that an error has closed.

        Args:
          error: the remaining error, in the unit of the others.

        Returns:
          1 if the error is down to the floor, 0 if it is as large as before; None if
          the nominal sim was no worse than the noise, or there is no error.
        """
        if error is None or self.nominal <= self.floor:
            return None
        return (self.nominal - error) / (self.nominal - self.floor)


@dataclass(frozen=True, kw_only=True)
class ChannelFit(Errors):
    """The errors of one channel, in the channel's unit.

    Attributes:
      unit: the channel's.

    Example:
      See docs/diagnosis_json.md.
    """

    unit: str


@dataclass(frozen=True, kw_only=True)
class Fit(Errors):
    """The errors of all channels together, in multiples of each channel's noise floor.

    They are the root of the mean over channels of (error / floor) squared.

    Attributes:
      channels: the errors of each channel by its name.

    Example:
      See docs/diagnosis_json.md.
    """

    channels: Mapping[str, ChannelFit]
