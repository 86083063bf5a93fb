"""What a prediction found: `result.json`, format 1 (docs/prediction_json.md)."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from diagnosis import Prediction, Verdict
from diagnosis.conclude.error_ratio import LEVEL, Ratio, Unit
from diagnosis.residuals.predictor import Model
from diagnosis.verdict import PlacedEffect, VerdictKind
from experiments.prediction.judgement import Judgement, judge, judgement_line
from groundwalk.arrays import FloatArray
from groundwalk.json_data import from_plain, parse_object, to_plain

FORMAT = 1
FLOORS = "noise floors"
"""Unit of errors of all channels together: multiples of each channel's noise floor."""

_SMALLEST = 1e-12
"""Smallest error [noise floors] that is divided by."""


@dataclass(frozen=True)
class Errors:
    """Rms errors of both sims, and how many times smaller the corrected sim's is.

    Attributes:
      nominal: error of the sim as it was.
      corrected: error of the corrected sim.
      floor: noise floor.
      unit: unit of these three.
      ratio: nominal / corrected.
      low, high: ends of its 95 % interval; None for a single recording.
    """

    nominal: float
    corrected: float
    floor: float
    unit: str
    ratio: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Interval:
    """How intervals were made: their level, and how many units of what were drawn."""

    level: float
    unit: Unit
    units: int


@dataclass(frozen=True)
class Promise:
    """Errors [noise floors] on the diagnosis' own held-out recordings; their ratio."""

    nominal: float
    corrected: float
    ratio: float


@dataclass(frozen=True)
class Recorded:
    """A recording that was given.

    Attributes:
      name: its name.
      used: whether the diagnosis has used it; then it is not predicted, and other
        fields are None or empty.
      seconds: length of what was replayed.
      together: errors over all channels.
      channels: errors in each channel.
    """

    name: str
    used: bool
    seconds: float | None = None
    together: Errors | None = None
    channels: Mapping[str, Errors] | None = None


@dataclass(frozen=True)
class PredictionResult:
    """Whether the corrected sim of a diagnosis predicts new recordings better.

    Attributes:
      judgement: by the interval of the ratio of errors over all channels.
      sentence: the same in words.
      robot, base: of the recordings.
      verdict: kind of the diagnosis' verdict.
      effects: those of the verdict that the corrected sim has.
      left_out: those that acted in one of its recordings only.
      together, channels: errors over all recordings that are new.
      interval: how the intervals were made.
      promise: what the diagnosis measured; None if it held nothing out.
      recordings: all that were given.
      limits: sentences on what this does not tell.
    """

    judgement: Judgement
    sentence: str
    robot: str
    base: str
    verdict: VerdictKind
    effects: tuple[PlacedEffect, ...]
    left_out: tuple[PlacedEffect, ...]
    together: Errors
    channels: Mapping[str, Errors]
    interval: Interval
    promise: Promise | None
    recordings: tuple[Recorded, ...]
    limits: tuple[str, ...]

    def to_json(self) -> str:
        """The result as JSON text; the same result gives the same text."""
        plain = {"format": FORMAT, **to_plain(self)}
        return json.dumps(plain, indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read the JSON text of a result; BadValueError if it is none."""
        return from_plain(cls, parse_object(text, "result", FORMAT), "result")


def result_of(
    found: Prediction,
    verdict: Verdict,
    events: Model,
    used: Sequence[Path],
    limits: Sequence[str],
    seed: np.random.SeedSequence,
) -> PredictionResult:
    """Errors and judgement of a prediction.

    Args:
      found: the recordings as both sims predict them.
      verdict: that of the diagnosis.
      events: effects that were left out.
      used: recordings that the diagnosis has used.
      limits: further sentences on what the result does not tell.
      seed: of the draws from which intervals follow.
    """
    squares = found.squares()
    ratio, ratios = squares.ratios(seed)
    together, channels = _errors(found, *squares.rms(), ratio, ratios)
    out = {one.key for one in events}
    named = [PlacedEffect(one.name, one.place) for one in verdict.effects]
    return PredictionResult(
        judge(ratio, together.nominal),
        judgement_line(ratio, together.nominal),
        found.plant.name,
        found.plant.base,
        verdict.kind,
        effects=tuple(one for one in named if one.key not in out),
        left_out=tuple(one for one in named if one.key in out),
        together=together,
        channels=channels,
        interval=Interval(LEVEL, squares.unit, len(squares.count)),
        promise=_promise(verdict),
        recordings=(*_recordings(found), *(Recorded(one.stem, True) for one in used)),
        limits=(*limits, *found.limits),
    )


def _errors(
    found: Prediction,
    before: FloatArray,
    after: FloatArray,
    ratio: Ratio | None = None,
    ratios: Sequence[Ratio] = (),
) -> tuple[Errors, dict[str, Errors]]:
    """Errors of all channels together and of each, from (c,) rms [noise floors]."""
    channels = {
        name: _pair(*pair, floor, unit, ratios[i] if ratios else None)
        for i, ((name, (floor, unit)), pair) in enumerate(
            zip(found.channels.items(), zip(before, after, strict=True), strict=True)
        )
    }
    nominal, corrected = (float(np.sqrt(np.mean(one**2))) for one in (before, after))
    return _pair(nominal, corrected, 1.0, FLOORS, ratio), channels


def _pair(
    before: float, after: float, floor: float, unit: str, ratio: Ratio | None
) -> Errors:
    """Errors in `unit`, from those in noise floors."""
    errors = float(before * floor), float(after * floor), floor, unit
    if ratio is not None:
        return Errors(*errors, ratio.value, ratio.low, ratio.high)
    return Errors(*errors, float(max(before, _SMALLEST) / max(after, _SMALLEST)))


def _recordings(found: Prediction) -> list[Recorded]:
    """The new recordings, each with its own errors."""
    squares, recordings = found.squares_by_recording(), []
    for k, trace in enumerate(found.traces):
        weight = np.zeros(len(found.traces))
        weight[k] = 1.0
        together, channels = _errors(found, *squares.rms(weight))
        own = trace.recording, False, trace.duration_s, together, channels
        recordings.append(Recorded(*own))
    return recordings


def _promise(verdict: Verdict) -> Promise | None:
    """What the diagnosis measured on recordings that it held out."""
    fit = verdict.fit
    if fit is None:
        return None
    ratio = max(fit.nominal, _SMALLEST) / max(fit.corrected, _SMALLEST)
    return Promise(fit.nominal, fit.corrected, ratio)
