"""Real, sim and corrected sim over time, on a recording that was kept out."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from diagnosis.verdict.verdict import Fit
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError


class ChannelSeries(NamedTuple):
    """One channel, arrays (T,); NaN is a missing value."""

    real: FloatArray
    sim: FloatArray
    corrected: FloatArray


@dataclass(frozen=True, eq=False)
class ReportSeries:
    """A held-out recording, or a part of one, and what the sims make of it.

    Attributes:
      name: of the recording.
      time_s: (T,) increasing.
      channels: by name, such as "position.LKneePitch" or "base.orientation.w"; the
        first component says the quantity.
    """

    name: str
    time_s: FloatArray
    channels: Mapping[str, ChannelSeries]

    def __post_init__(self) -> None:
        """Refuse arrays that do not fit together.

        Raises:
          BadValueError: there are not two ticks, no channels, or one is of another
            length.
        """
        if self.time_s.ndim != 1 or self.time_s.size < 2 or not self.channels:
            raise BadValueError(
                f"series {self.name!r} must have a channel and two ticks at least"
            )
        for name, channel in self.channels.items():
            for part, values in channel._asdict().items():
                if values.shape != self.time_s.shape:
                    raise BadValueError(
                        f"series {self.name!r}: {part} of {name} has shape "
                        f"{values.shape}, time_s has {self.time_s.shape}"
                    )


def rms(values: FloatArray) -> float:
    """Root of the mean square of what is not missing; 0 if all is."""
    known = values[~np.isnan(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else 0.0


def by_error(series: ReportSeries, fit: Fit | None) -> list[str]:
    """The channels that were scored, the one that the nominal sim misses most first.

    Errors count in multiples of the channel's floor; channels without one, such as the
    pose of a base that nothing measured, are left out unless no channel has one.
    """
    floors = {name: one.floor for name, one in fit.channels.items()} if fit else {}
    scored = [name for name in series.channels if floors.get(name)]
    errors = {
        name: rms(series.channels[name].real - series.channels[name].sim)
        / floors.get(name, 1.0)
        for name in scored or series.channels
    }
    return sorted(errors, key=lambda name: -errors[name])
