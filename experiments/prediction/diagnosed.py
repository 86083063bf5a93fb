"""Reads the run of a diagnosis: robot, drive, gains, verdict and corrected sim."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from diagnosis import Plant, Verdict
from diagnosis.conclude.soft_friction import CREEPS
from diagnosis.corrected.effects_json import (
    CORRECTED_JSON,
    DIAGNOSIS_JSON,
    load_correction,
)
from diagnosis.effects import effect
from diagnosis.residuals.predictor import Model
from diagnosis.verdict import Found, PlacedEffect
from experiments.runs.folder import CONFIG, RunFolder
from groundwalk.errors import BadRecordingError, BadValueError
from worlds.recordings.stated_model import MODEL_FILES

VERB = "diagnose"

SAME = 1e-9
"""Largest difference, as a share, of numbers that were written twice."""


@dataclass(frozen=True, eq=False)
class DiagnosisRun:
    """The run of a diagnosis that found effects.

    Attributes:
      path: its folder.
      options: those of the verb diagnose, by name.
      verdict: what was found.
    """

    path: Path
    options: Mapping[str, Any]
    verdict: Verdict

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read the folder of a run.

        Raises:
          RunFolderError: there is no run, it is of another verb, or it did not end.
          BadValueError: the verdict cannot be read, or there is no corrected sim.
        """
        folder = RunFolder.at(path, VERB)
        folder.read_json(DIAGNOSIS_JSON)  # says so if the run did not get there
        try:
            verdict = Verdict.from_json((path / DIAGNOSIS_JSON).read_text())
        except BadValueError as error:
            raise BadValueError(f"{path / DIAGNOSIS_JSON}: {error}") from None
        if not verdict.effects:
            raise BadValueError(
                f"the verdict of {path} is {verdict.kind!r}: no effect is named, so "
                "that there is no corrected sim to check; its report says what to "
                "record next"
            )
        if not folder.has(CORRECTED_JSON):
            raise BadValueError(
                f"{path} has no {CORRECTED_JSON}, which holds the corrected sim: "
                "repeat the diagnosis"
            )
        return cls(path, folder.read_json(CONFIG), verdict)

    @property
    def changed(self) -> bool:
        """Whether the question was what has changed since a reference."""
        return bool(self.options.get("reference"))

    @property
    def recordings(self) -> tuple[Path, ...]:
        """Files and folders of recordings that the diagnosis has seen."""
        names = ("recordings", "reference")
        return tuple(Path(one) for key in names for one in self.options.get(key) or ())

    def robot(self, other: str) -> str:
        """The robot model of the run, or another one that is given.

        Raises:
          BadValueError: none is given, and the run's model file is gone.
        """
        robot = other or str(self.options.get("robot") or "")
        if not other and Path(robot).suffix in MODEL_FILES and not Path(robot).exists():
            raise BadValueError(
                f"{robot}, the robot model of {self.path}, is no longer there: give it "
                "with --robot"
            )
        return robot

    @property
    def creeps(self) -> bool:
        """Whether dry friction lets joints creep, as the verdict says."""
        return CREEPS in self.verdict.limits

    @property
    def compares_torques(self) -> bool | None:
        """Whether torques were compared, not motions; None if that is not known."""
        fit = self.verdict.fit
        if fit is None:
            return None
        return all(name.startswith("torque.") for name in fit.channels)

    def check_joints(self, plant: Plant) -> None:
        """Refuse recordings with other joints than the diagnosed ones.

        Raises:
          BadRecordingError: a joint is in only one of both.
        """
        names = self.verdict.fit.channels if self.verdict.fit else ()
        kind = "torque." if self.compares_torques else "position."
        known = {one.removeprefix(kind) for one in names if one.startswith(kind)}
        differing = sorted(known ^ set(plant.joints)) if known else []
        if differing:
            there = "diagnosis" if differing[0] in known else "recordings"
            raise BadRecordingError(
                f"only the {there} {'has' if there == 'diagnosis' else 'have'} joint "
                f"{differing[0]!r}: recordings to be predicted need the joints of "
                f"{self.path}"
            )

    def sims(self, plant: Plant) -> tuple[Model, Model, Model]:
        """The effects of the sim as it was, of the corrected one, and those left out.

        As it was is without any, or with those of the healthy robot if recordings of
        it were given. Left out is what happened in a single recording, such as a push:
        it is no physics of the robot.

        Raises:
          BadModelError: the effects are of another robot.
        """
        every = list(load_correction(self.path / CORRECTED_JSON, plant))
        named, events = list[PlacedEffect](), list[PlacedEffect]()
        for found in self.verdict.effects:
            own = [one for one in every if _is(plant, one, found)]
            named += own
            events += own if found.when.recording is not None else []
        before = [one for one in every if one not in named] if self.changed else []
        after = [one for one in every if one not in events]
        return tuple(before), tuple(after), tuple(events)


def _is(plant: Plant, placed: PlacedEffect, found: Found) -> bool:
    """Whether an effect of the corrected sim is one that the verdict names."""
    if (placed.name, placed.place) != (found.name, found.place):
        return False
    names = [one.name for one in effect(placed.name).parameters(plant, placed.place)]
    pairs = [
        (value, found.parameters[name].value)
        for name, value in zip(names, placed.values, strict=True)
        if name in found.parameters
    ]
    return all(np.isclose(one, other, rtol=SAME, atol=0.0) for one, other in pairs)
