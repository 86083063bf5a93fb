"""Makes one concealed case: draws it, simulates it, writes recordings and truth."""

import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from experiments.concealed.draw import (
    CaseSort,
    Concealed,
    drawn_effects,
    drawn_sensors,
)
from experiments.concealed.motion import CaseMotion
from experiments.concealed.reading import PLANT_FILE, RECORDINGS, REFERENCE
from experiments.concealed.size_by_information import drawn_nats, ease_that_tells, nats
from groundwalk.errors import GroundwalkError
from groundwalk.files import write_text
from worlds.hidden.effects import Hidden
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import Run, run_hidden
from worlds.hidden.scales import scales
from worlds.hidden.setting import Scales
from worlds.recordings.files import write_recording
from worlds.recordings.metadata import RecordingMetadata

REFERENCES = (0, 2)
"""Numbers of the motions that the healthy robot is recorded in, too."""
_SCALE_STEP_S = 0.0005
"""Physics step [s] while sizes are sought: coarser than in recordings, and faster."""
_ATTEMPTS = 30
"""Draws of a case before it is given up."""
_SOURCE = "groundwalk concealed"


def case_name(number: int) -> str:
    """The name of a case, such as "case_007"."""
    return f"case_{number:03d}"


def make_case(cases: Path, truths: Path, seed: int, number: int) -> None:
    """Make one case: write its truth, then its folder, which is never incomplete.

    Args:
      cases: folder of all cases.
      truths: folder for the truths; gets a file such as `case_000.json`.
      seed: of the set.
      number: of the case.

    Raises:
      GroundwalkError: in every attempt the robot fell, or no size of the effect showed
        as clearly in the recordings as was drawn.
    """
    for attempt in range(_ATTEMPTS):
        maker = _Maker(seed, number, attempt)
        if maker.run():
            break
    else:
        raise GroundwalkError(
            f"case {number} of seed {seed}: in every attempt the robot fell, or the "
            "effect hardly showed"
        )
    name = case_name(number)
    unfinished = cases / f".{name}.partial"
    shutil.rmtree(unfinished, ignore_errors=True)
    maker.write(unfinished)
    write_text(truths / f"{name}.json", json.dumps(maker.truth(), indent=1) + "\n")
    unfinished.rename(cases / name)


@dataclass(frozen=True, eq=False)
class _Made:
    """A simulated motion, its number, and the effects that were hidden in it."""

    motion: int
    run: Run
    effects: Sequence[Hidden]


class _Maker:
    """One attempt at a case; plant, kind and engine are the same in every attempt."""

    def __init__(self, seed: int, number: int, attempt: int) -> None:
        # Lists of numbers, not spawned children: a case knows nothing of the others.
        def rng(part: int) -> np.random.Generator:
            return np.random.default_rng([seed, number, attempt, part])

        self._sort = CaseSort.drawn(np.random.default_rng([seed, number]))
        self._noise = rng(0)
        self._ground = np.random.SeedSequence([seed, number, attempt, 1])
        self._drawing = partial(rng, 2)
        self._nats = drawn_nats(rng(5))
        sensors, jitter_s = drawn_sensors(self._sort.kind, rng(3))
        self._sensors: HiddenSensors = sensors
        self._motion = CaseMotion.drawn(
            self._sort.plant, self._sort.kind == "unexcited", jitter_s, rng(4)
        )
        self._reference: list[_Made] = []
        self._runs: list[_Made] = []
        self._hidden: Concealed | None = None

    def run(self) -> bool:
        """Simulate all motions; False if the robot fell or no size fits."""
        motion = self._motion
        engine = self._sort.engine
        if motion.plant.floating:
            self._reference = [self._move(number, (), engine) for number in REFERENCES]
            nominal = [made.run for made in self._reference]
        else:
            nominal = [self._move(0, (), "mujoco", _SCALE_STEP_S).run]
        if not all(run.ok for run in nominal):
            return False
        self._hidden = self._concealed(scales(motion.plants[0], nominal))
        if self._hidden is None:
            return False
        for number in range(len(motion.names)):
            made = self._move(number, self._hidden.effects, engine)
            self._runs.append(made)
            if not made.run.ok:
                return False
        return True

    def _concealed(self, does: Scales) -> Concealed | None:
        """The hidden effects with their sizes; None if no size fits the drawn level.

        A single effect on a fixed base gets the size at which its recordings tell as
        many nats as were drawn. Other sizes are drawn directly: on a robot that stands
        or walks, tiny differences grow into large ones, so that information says
        little.
        """
        motion = self._motion

        def drawn(ease: float | None = None) -> Concealed:
            return drawn_effects(
                self._sort,
                motion.plant,
                does,
                motion.places,
                motion.duration_s,
                self._drawing(),
                ease,
            )

        if self._sort.kind != "single" or motion.plant.floating:
            return drawn()
        nominal = self._trials(())
        ease = ease_that_tells(
            self._nats,
            lambda one: nats(nominal, self._trials(drawn(one).effects), self._sensors),
            drawn().ease,
        )
        return None if ease is None else drawn(ease)

    def _trials(self, effects: Sequence[Hidden]) -> list[Run]:
        """All motions in coarse physics steps, for finding the size of an effect."""
        return [
            self._move(number, effects, self._sort.engine, _SCALE_STEP_S).run
            for number in range(len(self._motion.names))
        ]

    def _move(
        self,
        number: int,
        effects: Sequence[Hidden],
        engine: str,
        step_s: float | None = None,
    ) -> _Made:
        motion = self._motion
        start_rad, feed = motion.feed(number)
        plant = motion.plants[number]
        clock = motion.clock(number, step_s)
        run = run_hidden(plant, effects, engine, clock, feed, start_rad, self._ground)
        return _Made(number, run, effects)

    def write(self, folder: Path) -> None:
        """Write the nominal model and the recordings into a folder."""
        plant = self._motion.plant
        robot = plant.name
        if plant.file is not None:
            robot, text = plant.file
            write_text(folder / robot, text)
        base = "floating" if plant.floating else "fixed"
        content = json.dumps({"robot": robot, "base": base}, indent=1)
        write_text(folder / PLANT_FILE, content + "\n")
        for made in self._runs:
            self._write(folder / RECORDINGS, made, robot, base)
        for made in self._reference:
            self._write(folder / REFERENCE, made, robot, base)

    def _write(self, folder: Path, made: _Made, robot: str, base: str) -> None:
        plant = self._motion.plants[made.motion]
        metadata = RecordingMetadata(robot, base, _SOURCE, servo=plant.servo)
        recording = hidden_recording(
            plant, made.run, made.effects, self._sensors, self._noise, metadata
        )
        name = f"{made.motion}_{self._motion.names[made.motion]}.parquet"
        write_recording(recording, folder / name)

    def truth(self) -> dict[str, Any]:
        """The case's entry in the sealed file."""
        hidden = self._hidden
        if hidden is None:
            raise GroundwalkError("the case has not been run")
        return {
            "plant": self._sort.plant,
            "engine": self._sort.engine,
            "kind": self._sort.kind,
            "effects": [
                {
                    "name": effect.name,
                    "place": effect.place,
                    "parameters": dict(effect.parameters),
                }
                for effect in hidden.effects
            ],
            "size": hidden.ease if hidden.effects else None,
            "held": [
                joint
                for joint, moves in zip(
                    self._motion.plant.joints, self._motion.moves, strict=True
                )
                if not moves
            ],
        }
