"""The oracle: what the true structure reaches when its values are fitted.

How much a case can tell is measured, not felt: the true effects at their true places
are fitted to the same recordings that a diagnosis fits, and by how much that beats the
nominal model is the case's level.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from diagnosis.corrected.effects_json import EffectValues
from diagnosis.effects.effect import PlacedEffect
from diagnosis.effects.library import EFFECTS, effect
from diagnosis.plant.plant import Plant
from diagnosis.residuals.channels import channels_of
from diagnosis.residuals.predictor import Model, Predictor
from diagnosis.search.fitting import fit_all
from diagnosis.search.reference import standing_of
from diagnosis.traces.split import split
from diagnosis.traces.trace import Trace
from diagnosis.verdict.verdict import Found
from experiments.concealed.reading import read_case
from experiments.concealed.scoring.truth import TrueCase
from experiments.concealed.size_by_information import level_of
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.blas import one_blas_thread


@dataclass(frozen=True)
class Oracle:
    """What the true structure reaches in one case.

    Attributes:
      gain: log-score [nats] per recording by which it beats the nominal model.
      nominal: rms error on held-out recordings, in units of noise.
      fitted: the same with the true structure, refitted.
      neutral: value at which a parameter does nothing, by "effect@place" and name;
        None where that is infinite.
      answered: by method, the hash of its effects and the held-out rms with them.
    """

    gain: float
    nominal: float
    fitted: float
    neutral: Mapping[str, Mapping[str, float | None]]
    answered: Mapping[str, tuple[str, float]]

    @property
    def level(self) -> str:
        """How easy the case is."""
        return level_of(self.gain)

    def to_json(self) -> str:
        """As text."""
        return json.dumps(asdict(self), indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Oracle":
        """What `to_json` has written."""
        plain = json.loads(text)
        answered = {name: (key, rms) for name, (key, rms) in plain["answered"].items()}
        return cls(**{**plain, "answered": answered})


def answer_key(found: Sequence[Found]) -> str:
    """Tells one set of effects with their values from another."""
    text = json.dumps(
        [
            [each.name, each.place, {k: e.value for k, e in each.parameters.items()}]
            for each in found
        ]
    )
    return hashlib.sha256(text.encode()).hexdigest()


@one_blas_thread
def consult(
    folder: Path, case: TrueCase, answers: Mapping[str, Sequence[Found]]
) -> Oracle:
    """Fit the true structure, and replay what others found on held-out recordings.

    Args:
      folder: of the case.
      case: the truth.
      answers: by method, the effects it found.
    """
    plant, traces, reference = read_case(folder)
    parts = split(traces)
    channels = channels_of(plant, [*traces, *reference])
    standing = standing_of(plant, reference, channels) if reference else None
    start = tuple(_true(plant, each) for each in case.effects)
    fitting = Predictor(plant, parts.fit, channels, standing=standing)
    fitting.calibrate(start)
    model = fit_all(fitting, [start])[0].model
    used = [*parts.fit, *parts.select, *parts.test]
    every = Predictor(plant, used, channels, standing=standing)
    every.calibrate(model)
    models = [_answered(plant, traces, found) for found in answers.values()]
    residuals = every.residuals([(), model, *models])
    held_out = every.trace >= len(parts.fit) + len(parts.select)
    error = np.sqrt(np.mean(residuals[:, held_out & every.scored] ** 2, axis=1))
    keys = [answer_key(found) for found in answers.values()]
    return Oracle(
        gain=log_score_gain(residuals[0], residuals[1], every.channel) / len(traces),
        nominal=float(error[0]),
        fitted=float(error[1]),
        neutral={one.key: _neutral(plant, one) for one in start},
        answered={
            name: (key, float(rms))
            for name, key, rms in zip(answers, keys, error[2:], strict=True)
        },
    )


def log_score_gain(nominal: FloatArray, fitted: FloatArray, channel: IntArray) -> float:
    """Log-likelihood [nats] that a fitted model has over the nominal one.

    Errors are taken as Gaussian. What the true structure cannot explain, such as the
    difference of two engines, is noise as well: a channel's variance is the larger of
    its sensor's and of what the fitted model leaves.

    Args:
      nominal: (N,) residual in units of the sensor's noise; 0 where not scored.
      fitted: (N,) likewise.
      channel: (N,) of each value.
    """
    gain = 0.0
    for number in np.unique(channel):
        mine = channel == number
        seen = mine & ((nominal != 0) | (fitted != 0))
        if seen.any():
            variance = max(1.0, float(np.mean(fitted[seen] ** 2)))
            gain += (
                0.5 * float(np.sum(nominal[seen] ** 2 - fitted[seen] ** 2)) / variance
            )
    return gain


def _true(plant: Plant, true: EffectValues) -> PlacedEffect:
    """The hidden effect in the diagnosis' words, within its bounds."""
    values = [
        min(max(true.parameters.get(p.name, p.typical), p.low), p.high)
        for p in effect(true.name).parameters(plant, true.place)
    ]
    return PlacedEffect(true.name, true.place, tuple(values))


def _answered(plant: Plant, traces: Sequence[Trace], found: Sequence[Found]) -> Model:
    """What an answer says, as a model; what the plant cannot have is left out."""
    model = []
    for each in found:
        known = EFFECTS.get(each.name)
        if known is None or each.place not in known.places(plant, traces):
            continue
        given = {name: estimate.value for name, estimate in each.parameters.items()}
        values = [
            min(max(given.get(p.name, p.typical), p.low), p.high)
            for p in known.parameters(plant, each.place)
        ]
        model.append(PlacedEffect(each.name, each.place, tuple(values)))
    return tuple(model)


def _neutral(plant: Plant, placed: PlacedEffect) -> dict[str, float | None]:
    parameters = effect(placed.name).parameters(plant, placed.place)
    values = {
        p.name: float(p.neutral) if np.isfinite(p.neutral) else None for p in parameters
    }
    if placed.name == "end_stop" and placed.values[1] < 0:
        values["angle"] = parameters[0].low  # of the other side
    return values
