"""Makes a test case of set 1: draws and simulates it."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from experiments.concealed.draw import CaseSort, Concealed, drawn_effects, drawn_sensors
from experiments.concealed.motion import CaseMotion
from experiments.concealed.size_by_information import drawn_nats, ease_that_tells, nats
from experiments.concealed.written import SOURCE, MadeCase
from groundwalk.errors import GroundwalkError
from worlds.hidden.effects import Hidden
from worlds.hidden.recorded import hidden_recording
from worlds.hidden.run import Run, run_hidden
from worlds.hidden.scales import scales
from worlds.hidden.setting import Scales
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording

REFERENCES = (0, 2)
"""Indices of the motions that are also recorded without hidden effects (reference)."""
_SCALE_STEP_S = 0.0005
"""Physics step [s] in the search for an effect's size: coarse, and therefore fast."""
_ATTEMPTS = 30
"""Largest number of times that a test case is drawn before it is given up."""


def first_case(seed: int, number: int, count: int) -> MadeCase:
    """Make a test case of set 1; it depends on the set's seed and its own number only.

    `count`, the number of cases, is not used. GroundwalkError if in every attempt the
    robot fell, or no size of the effect was as visible in the recordings as the level
    that was drawn demands.
    """
    for attempt in range(_ATTEMPTS):
        maker = _Maker(seed, number, attempt)
        if maker.run():
            return maker.made()
    raise GroundwalkError(
        f"case {number} of seed {seed}: in every attempt the robot fell, or the "
        "effect hardly showed"
    )


class _Maker:
    """One attempt to make a test case: recordings with hidden physics, and their truth.

    All attempts at a case have the same robot, kind of case and physics engine.
    """

    def __init__(self, seed: int, number: int, attempt: int) -> None:
        # Seeds are lists of numbers, so that a case does not depend on the others.
        def rng(part: int) -> np.random.Generator:
            return np.random.default_rng([seed, number, attempt, part])

        self._sort = CaseSort.drawn(np.random.default_rng([seed, number]))
        self._noise = rng(0)
        self._ground = np.random.SeedSequence([seed, number, attempt, 1])
        self._drawing = partial(rng, 2)
        self._nats = drawn_nats(rng(5))
        self._sensors, jitter_s = drawn_sensors(self._sort.kind, rng(3))
        self._motion = CaseMotion.drawn(
            self._sort.plant, self._sort.kind == "unexcited", jitter_s, rng(4)
        )
        self._reference: dict[int, Run] = {}
        self._runs: dict[int, Run] = {}
        self._hidden: Concealed | None = None

    def run(self) -> bool:
        """Simulate all motions; False if the robot fell or no effect size fits."""
        motion, engine = self._motion, self._sort.engine
        if motion.plant.floating:
            self._reference = {i: self._move(i, (), engine) for i in REFERENCES}
            nominal = list(self._reference.values())
        else:
            nominal = [self._move(0, (), "mujoco", _SCALE_STEP_S)]
        if not all(run.ok for run in nominal):
            return False
        self._hidden = self._concealed(scales(motion.plants[0], nominal))
        if self._hidden is None:
            return False
        for number in range(len(motion.names)):
            self._runs[number] = self._move(number, self._hidden.effects, engine)
            if not self._runs[number].ok:
                return False
        return True

    def _concealed(self, does: Scales) -> Concealed | None:
        """Draw the hidden effects with their sizes; None if no size fits.

        A single effect on a fixed base gets a size at which the recordings carry as
        much information about it as was drawn. Other sizes are drawn directly: on a
        robot that stands or walks, tiny differences grow, so that this information says
        little.
        """
        motion = self._motion
        case = self._sort, motion.plant, does, motion.places, motion.duration_s

        def drawn(ease: float | None = None) -> Concealed:
            return drawn_effects(*case, self._drawing(), ease)

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
        """Simulate all motions in coarse physics steps, to find an effect's size."""
        return [
            self._move(number, effects, self._sort.engine, _SCALE_STEP_S)
            for number in range(len(self._motion.names))
        ]

    def _move(
        self,
        number: int,
        effects: Sequence[Hidden],
        engine: str,
        step_s: float | None = None,
    ) -> Run:
        plant, clock = self._motion.plants[number], self._motion.clock(number, step_s)
        start_rad, feed = self._motion.feed(number)
        return run_hidden(plant, effects, engine, clock, feed, start_rad, self._ground)

    def made(self) -> MadeCase:
        """The case with its recordings, as noisy sensors make them, and its truth."""
        plant = self._motion.plant
        hidden = self._hidden.effects if self._hidden else ()
        return MadeCase(
            plant.name,
            plant.file,
            "floating" if plant.floating else "fixed",
            self._recorded(self._runs, hidden),
            self._recorded(self._reference, ()),
            self.truth(),
        )

    def _recorded(
        self, runs: Mapping[int, Run], effects: Sequence[Hidden]
    ) -> dict[str, Recording]:
        """The recordings of some runs by name, such as "0_multisine"."""
        made = {}
        for number, run in runs.items():
            plant = self._motion.plants[number]
            base = "floating" if plant.floating else "fixed"
            robot = plant.file[0] if plant.file else plant.name
            metadata = RecordingMetadata(robot, base, SOURCE, servo=plant.servo)
            made[f"{number}_{self._motion.names[number]}"] = hidden_recording(
                plant, run, effects, self._sensors, self._noise, metadata
            )
        return made

    def truth(self) -> dict[str, Any]:
        """The test case's entry in the sealed file: its kind, hidden effects ..."""
        hidden, motion = self._hidden, self._motion
        if hidden is None:
            raise GroundwalkError("the case has not been run")
        return {
            "plant": self._sort.plant,
            "engine": self._sort.engine,
            "kind": self._sort.kind,
            "effects": [vars(effect) for effect in hidden.effects],
            "size": hidden.ease if hidden.effects else None,
            "held": [motion.plant.joints[i] for i in np.flatnonzero(~motion.moves)],
        }
