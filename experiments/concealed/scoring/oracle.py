"""The oracle of a test case: how much its recordings can tell about its hidden effects.

The true effects at their true places are fitted to the recordings that a diagnosis
fits. The log-likelihood by which they beat the nominal model gives the case's level.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from diagnosis.conclude.oracle import fit_structure
from diagnosis.effects import PlacedEffect, all_effects, effect
from diagnosis.plant.plant import Plant
from experiments.concealed.reading import read_case
from experiments.concealed.scoring.answers import Named
from experiments.concealed.scoring.truth import TrueCase
from experiments.concealed.size_by_information import level_of
from groundwalk.json_data import from_plain, parse_json, to_plain


@dataclass(frozen=True)
class Oracle:
    """Result of fitting the true effects of one test case to its recordings.

    Attributes:
      gain: log-likelihood [nats] per recording by which the fitted true effects beat
        the nominal model.
      nominal: rms error of the nominal model on held-out recordings, in units of noise.
      fitted: that error with the fitted true effects.
      neutral: values of parameters that do nothing (None: infinity), by "effect@place".
      answered: for each method the hash of the effects found, and the error with them.
    """

    gain: float
    nominal: float
    fitted: float
    neutral: Mapping[str, Mapping[str, float | None]]
    answered: Mapping[str, tuple[str, float]]

    @property
    def level(self) -> str:
        """Level of difficulty of the test case, from "L1" (easiest) to "L4"."""
        return level_of(self.gain)

    def to_json(self) -> str:
        """The fit of the true effects as JSON text."""
        return json.dumps(to_plain(self), indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str) -> "Oracle":
        """Read a fit of true effects from the text of `to_json`; else BadValueError."""
        return from_plain(cls, parse_json(text, "oracle"), "oracle")


def answer_key(found: Sequence[Named]) -> str:
    """Hash of a list of effects with their places and values."""
    text = json.dumps([[each.name, each.place, _values(each)] for each in found])
    return hashlib.sha256(text.encode()).hexdigest()


def consult(
    folder: Path, case: TrueCase, answers: Mapping[str, Sequence[Named]]
) -> Oracle:
    """Fit a test case's true effects, and replay the answers on held-out recordings.

    `answers` are the effects found by each method. An effect that the diagnosis does
    not know, or not at that place, is left out. Of a robot on its feet recordings when
    it was healthy say what is noise; on a fixed base its small mismatch stays.
    """
    plant, traces, reference = read_case(folder)
    if plant.base == "fixed":  # else effects would be searched for, as in a diagnosis
        reference = None
    true = tuple(_placed(plant, e.name, e.place, e.parameters) for e in case.effects)
    found_effects = [
        tuple(
            _placed(plant, each.name, each.place, _values(each))
            for each in found
            if each.name in all_effects()
            and each.place in effect(each.name).places(plant, traces)
        )
        for found in answers.values()
    ]
    fit = fit_structure(plant, traces, reference, true, found_effects)
    keys = [answer_key(found) for found in answers.values()]
    neutral = {one.key: _neutral(plant, one) for one in true}
    answered = dict(zip(answers, zip(keys, fit.others, strict=True), strict=True))
    return Oracle(fit.gain, fit.nominal, fit.fitted, neutral, answered)


def _values(found: Named) -> dict[str, float]:
    return {name: estimate.value for name, estimate in found.parameters.items()}


def _placed(
    plant: Plant, name: str, place: str, values: Mapping[str, float]
) -> PlacedEffect:
    """An effect with values clipped to bounds; typical values for missing ones."""
    clipped = (
        min(max(values.get(p.name, p.typical), p.low), p.high)
        for p in effect(name).parameters(plant, place)
    )
    return PlacedEffect(name, place, tuple(clipped))


def _neutral(plant: Plant, placed: PlacedEffect) -> dict[str, float | None]:
    """Values at which an effect does nothing, by parameter; None for infinity."""
    kind = effect(placed.name)
    names = [one.name for one in kind.parameters(plant, placed.place)]
    values = kind.neutral_values(plant, placed)
    return {
        name: float(value) if np.isfinite(value) else None
        for name, value in zip(names, values, strict=True)
    }
