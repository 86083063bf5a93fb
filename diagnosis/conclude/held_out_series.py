"""Lists measured and simulated values over time on held-out recordings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from diagnosis.residuals.channels import measured_of
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.verdict import Fit
from groundwalk.arrays import FloatArray


class ChannelSeries(NamedTuple):
    """A quantity (T,) as measured, and as predicted by nominal and corrected sim.

    In SI units; NaN is a missing value.
    """

    real: FloatArray
    sim: FloatArray
    corrected: FloatArray


@dataclass(frozen=True, eq=False)
class HeldOutSeries:
    """A held-out recording, or a part of one, with the predictions of two sims.

    `channels` are by name, such as "position.LKneePitch"; the text before the first dot
    is the quantity. The times (T,) increase; they are those of the `recording`.
    """

    name: str
    time_s: FloatArray
    channels: Mapping[str, ChannelSeries]
    recording: str = ""


def held_out_series(
    nominal: Predictor, corrected: Predictor, model: Model, before: Model = ()
) -> list[HeldOutSeries]:
    """Measured values of held-out recordings, and those predicted by both sims.

    Both predictors are of the same recordings, `nominal` is calibrated at the effects
    `before`, `corrected` at `model`.
    """
    sim, after = _by_trace(nominal, before), _by_trace(corrected, model)
    series = []
    for k, trace in enumerate(corrected.traces):
        rows = corrected.seen_rows(trace)
        real = measured_of(trace, corrected.channels)[rows]
        channels = {
            name: ChannelSeries(real[:, i], sim[k][:, i], after[k][:, i])
            for i, name in enumerate(corrected.channels.names)
        }
        own = trace.time_s[rows], channels, trace.recording
        series.append(HeldOutSeries(trace.name, *own))
    return series


def _by_trace(predictor: Predictor, model: Model) -> Sequence[FloatArray]:
    """For each trace the (rows, channels) values that a model predicts."""
    predicted = predictor.predict([model])[0]
    seen = [trace.time_s[predictor.seen_rows(trace)] for trace in predictor.traces]
    ends = np.cumsum([len(time_s) for time_s in seen])
    return np.split(predicted, ends[:-1])


def rms(values: FloatArray) -> float:
    """Root mean square of the values that are not NaN; 0 if all are NaN."""
    known = values[~np.isnan(values)]
    return float(np.sqrt(np.mean(known**2))) if known.size else 0.0


def by_error(series: HeldOutSeries, fit: Fit | None) -> list[str]:
    """Names of channels in order of the nominal sim's rms error, the largest first.

    Errors are compared as multiples of each channel's noise floor, which `fit` holds.
    Channels without a floor, such as the pose of a base that nothing measured, are left
    out; if no channel has one, all are kept and compared in their own units.
    """
    floors = {name: one.floor for name, one in fit.channels.items()} if fit else {}
    scored = [name for name in series.channels if floors.get(name)]
    errors = {
        name: rms(series.channels[name].real - series.channels[name].sim)
        / floors.get(name, 1.0)
        for name in scored or series.channels
    }
    return sorted(errors, key=lambda name: -errors[name])
