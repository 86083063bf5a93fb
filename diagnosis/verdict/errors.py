"""Errors before and after, on recordings that were kept out of the fit."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from groundwalk.json_data import check_number


@dataclass(frozen=True, kw_only=True)
class Errors:
    """Rms errors on recordings that were kept out of the fit; None: was not computed.

    Attributes:
      nominal: of the sim as it was.
      corrected: of the sim with the effects found.
      floor: what the noise alone makes.
      ceiling: what a flexible regression without physics reaches.
      without: of the effects found, refitted without the one that closes most.
      wrong_place: of that one at the other place that does best, and the rest.
      wrong_effect: of another effect at its place, drawn by lot, and the rest.
    """

    nominal: float
    corrected: float
    floor: float
    ceiling: float | None = None
    without: float | None = None
    wrong_place: float | None = None
    wrong_effect: float | None = None

    def __post_init__(self) -> None:
        """Refuse errors that are negative."""
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
        """Part of the nominal error above the floor that is gone where `error` is left.

        None where the nominal sim was no worse than the noise, or there is no error.
        """
        if error is None or self.nominal <= self.floor:
            return None
        return (self.nominal - error) / (self.nominal - self.floor)


@dataclass(frozen=True, kw_only=True)
class ChannelFit(Errors):
    """The errors of one channel, in its unit."""

    unit: str


@dataclass(frozen=True, kw_only=True)
class Fit(Errors):
    """The errors of all channels together, in multiples of each channel's floor.

    Together: the root of the mean over channels of (error / floor) squared.
    """

    channels: Mapping[str, ChannelFit]
