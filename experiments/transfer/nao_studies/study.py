"""The cells of the NAO study: how each finds its gait, and how that walks on real."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import robots
from experiments.grounded_walks.courses import Places, RealCourse
from experiments.grounded_walks.data import GaitCloud
from experiments.grounded_walks.methods import (
    GAT,
    NONE,
    SGAT,
    UNEVEN,
    action_envelope,
)
from experiments.grounded_walks.raters import (
    GroundedRater,
    RandomisedRater,
    RealRater,
)
from experiments.grounded_walks.sim import ROBOT, GroundedSim
from experiments.grounded_walks.step import Grounding, cloud_around
from experiments.runs.folder import HISTORY, RunFolder
from experiments.transfer.nao_studies.page import CELLS, DIAGNOSED, DIAGNOSED_SIM
from experiments.walking.evaluation import Study, evaluate
from experiments.walking.tuning import Budget, Rater, tune
from walk_engine import Gait, gaits

START, ANE, RANDOMISED, REAL = "start gait", "ANE", "randomisation", "search on real"
DIAGNOSED_UNEVEN, DIAGNOSED_SGAT = (f"{name}, {DIAGNOSED}" for name in (UNEVEN, SGAT))
ON_DIAGNOSED = {DIAGNOSED_UNEVEN: UNEVEN, DIAGNOSED_SGAT: SGAT}
"""Groundings of a diagnosed sim."""

PLAN = (
    (START, 0),
    (DIAGNOSED_SIM, 1),
    (DIAGNOSED_UNEVEN, 1),
    (DIAGNOSED_UNEVEN, 2),
    (DIAGNOSED_SGAT, 1),
    (DIAGNOSED_SGAT, 2),
    (UNEVEN, 1),
    (UNEVEN, 2),
    (SGAT, 1),
    (GAT, 1),
    (SGAT, 2),
    (GAT, 2),
    (NONE, 1),
    (RANDOMISED, 1),
    (ANE, 1),
    (REAL, 1),
)
"""Method and grounding step of every cell, in the order in which they are computed."""

METHODS = (UNEVEN, SGAT, GAT, NONE, RANDOMISED, ANE, REAL)
WITH_SIM = (NONE, UNEVEN, DIAGNOSED_SIM, DIAGNOSED_UNEVEN)
"""What is compared by default, without and with a diagnosed sim, on uneven ground."""

WITH_SIM_ON_FLAT = (NONE, SGAT, DIAGNOSED_SIM, DIAGNOSED_SGAT)
"""The same where real is flat: what makes gaits fall there are no lumps."""

ENVELOPES_RAD = (0.02, 0.05)
ENVELOPE_WALKS = 12
OF_DATA, OF_SEARCH, OF_TRIALS, OF_ENVELOPES = range(4)


@dataclass(frozen=True)
class Effort:
    """How much is walked and searched.

    Attributes:
      trials: of each gait found.
      repeats: walks of each gait in a stochastic sim.
      walks: real ones of the first grounding step, and of each further one.
      sim_walks: of each grounding step.
      sim: budget of searches in the sim.
      real: budget of the search on real.
    """

    trials: int
    repeats: int
    walks: tuple[int, int]
    sim_walks: int
    sim: Budget
    real: Budget


class NaoStudy:
    """The cells so far, and the groundings that several of them share."""

    def __init__(
        self, folder: RunFolder, effort: Effort, places: Places, seed: int
    ) -> None:
        """Go on where the folder's run has ended.

        Args:
          folder: the run.
          effort: how much to do.
          places: the real course, and a sim that a diagnosis has corrected.
          seed: every random number follows from it.
        """
        self._folder, self._effort, self._entropy = folder, effort, seed
        self._diagnosed, self._plain = places, Places(places.real)
        state = folder.read_json(HISTORY) if folder.has(HISTORY) else {CELLS: []}
        self.cells: list[dict[str, Any]] = state[CELLS]
        self._first = self._first_step(self._plain)
        self._first_diagnosed = self._first_step(places, self._first)

    def _first_step(self, places: Places, beside: Grounding | None = None) -> Grounding:
        walks = self._effort.walks[0], self._effort.sim_walks
        return Grounding(
            gaits.get("start"),
            GaitCloud(),
            walks,
            self._seed(OF_DATA),
            places=places,
            beside=beside,
        )

    @property
    def _course(self) -> RealCourse:
        return self._plain.real

    def cell(self, method: str, step: int) -> Mapping[str, Any] | None:
        """What is known of a cell."""
        for cell in self.cells:
            if (cell["method"], cell["step"]) == (method, step):
                return cell
        return None

    def compute(self, method: str, step: int) -> None:
        """Find the cell's gait, try it on real, and write the cell down."""
        gait, facts = self._find(method, step)
        score = self._try(gait, self._effort.trials, OF_TRIALS)
        cell = {"method": method, "step": step, **score, **facts, "gait": dict(gait)}
        self.cells.append(cell)
        self._folder.write_json(HISTORY, {CELLS: self.cells})

    def _find(self, method: str, step: int) -> tuple[Gait, dict[str, Any]]:
        effort, start = self._effort, gaits.get("start")
        checkpoint = self._folder.path / f"search_{method}_{step}.pkl".replace(" ", "_")
        if method == START:
            return start, {"real_walks": 0}
        if method == ANE:
            return self._best_envelope(checkpoint)
        if method == REAL:
            rater: Rater = RealRater(self._course)
            gait = self._tune(checkpoint, start, rater, effort.real)
            return gait, {"real_walks": effort.real.rated}
        if method == RANDOMISED:
            rater = RandomisedRater(effort.repeats)
            return self._tune(checkpoint, start, rater), {"real_walks": 0}
        if method in (NONE, DIAGNOSED_SIM):
            places = self._plain if method == NONE else self._diagnosed
            rater = GroundedRater(GroundedSim(None, places.sim()), 1)
            return self._tune(checkpoint, start, rater), {"real_walks": 0}
        return self._grounded(checkpoint, method, step)

    def _grounded(
        self, checkpoint: Path, method: str, step: int
    ) -> tuple[Gait, dict[str, Any]]:
        """Step 1 shares its data, as all methods begin at the start gait."""
        effort, start = self._effort, gaits.get("start")
        name, grounding, places = method, self._first, self._plain
        if method in ON_DIAGNOSED:
            name, grounding = ON_DIAGNOSED[method], self._first_diagnosed
            places = self._diagnosed
        walks = effort.walks[0]
        if step == 2:
            before = self.cell(method, 1)
            assert before is not None
            start = Gait.from_mapping(before["gait"])
            more = effort.walks[1], effort.sim_walks
            seed = self._seed(OF_DATA, step)
            cloud = cloud_around(start)
            grounding = Grounding(start, cloud, more, seed, grounding, places)
            walks += effort.walks[1]
        rater = grounding.rater(name, 1 if method == GAT else effort.repeats)
        gait = self._tune(checkpoint, start, rater)
        return gait, {"real_walks": walks}

    def _best_envelope(self, checkpoint: Path) -> tuple[Gait, dict[str, Any]]:
        """The coarse grid of ANE: the noise whose gait earns most on real."""
        found = []
        for level in ENVELOPES_RAD:
            path = checkpoint.with_suffix(f".{1000 * level:.0f}mrad.pkl")
            envelope = GroundedSim(action_envelope(level))
            rater = GroundedRater(envelope, self._effort.repeats)
            gait = self._tune(path, gaits.get("start"), rater)
            score = self._try(gait, ENVELOPE_WALKS, OF_ENVELOPES)
            earned = score["speed_mean"] - 15 * score["falls"] / score["trials"]
            found.append((earned, level, gait))
        _, level, gait = max(found, key=lambda entry: entry[:2])
        walks = ENVELOPE_WALKS * len(found)
        return gait, {"real_walks": walks, "envelope_rad": level}

    def _tune(
        self, checkpoint: Path, start: Gait, rater: Rater, budget: Budget | None = None
    ) -> Gait:
        budget = budget or self._effort.sim
        return tune(checkpoint, start, budget, rater, self._seed(OF_SEARCH))

    def _try(self, gait: Gait, trials: int, use: int) -> dict[str, Any]:
        course = self._course
        study = Study("real", course.terrain, trials, hidden=course.hidden)
        name = "gait"
        outcome = evaluate(study, robots.get(ROBOT), {name: gait}, self._seed(use))
        score = asdict(outcome[name].score)
        return {
            "speed_mean": score["speed_cm_s"],
            "speed_std": score["speed_std"],
            "falls": score["falls"],
            "trials": score["trials"],
        }

    def _seed(self, *use: int) -> np.random.SeedSequence:
        """The random numbers of one use, the same however often they are asked for."""
        return np.random.SeedSequence(self._entropy, spawn_key=use)
