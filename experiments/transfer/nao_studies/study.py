"""The cells of the NAO study: ways to find a gait, each tried in the real world.

A cell is one method after one grounding step. To try another grounding of
`sgat.transformers`, add its title to `PLAN`.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import robots
from experiments.grounded_walks.courses import Places, RealCourse
from experiments.grounded_walks.models import (
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
from experiments.grounded_walks.step import GroundingStep
from experiments.runs.folder import HISTORY, RunFolder
from experiments.transfer.nao_studies.page import (
    CELLS,
    DIAGNOSED,
    DIAGNOSED_SIM,
    worth_cm_s,
)
from experiments.walking.evaluation import Study, evaluate
from experiments.walking.tuning import Budget, Rater, tune
from sgat.transformers.catalogue import grounding
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import Gait, gaits

START, ANE, RANDOMISED, REAL = "start gait", "ANE", "randomisation", "search on real"
"""Methods without a grounding: the gait that all searches start from; searches in the
sim with the action noise envelope (ANE), with random dynamics, and in the real
world."""

_ON_DIAGNOSED = f", {DIAGNOSED}"
DIAGNOSED_UNEVEN, DIAGNOSED_SGAT = UNEVEN + _ON_DIAGNOSED, SGAT + _ON_DIAGNOSED
"""Methods that ground a sim which a diagnosis has corrected."""

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
"""Method and grounding step of each result, in the order of computation."""

METHODS = tuple(
    dict.fromkeys(name for name, _ in PLAN if name != START and DIAGNOSED not in name)
)
"""Methods that are compared by default if no diagnosis is given."""

WITH_SIM = (NONE, UNEVEN, DIAGNOSED_SIM, DIAGNOSED_UNEVEN)
"""Methods that are compared by default with a diagnosed sim, on uneven real ground."""

WITH_SIM_ON_FLAT = (NONE, SGAT, DIAGNOSED_SIM, DIAGNOSED_SGAT)
"""Methods that are compared by default with a diagnosed sim, on flat real ground. They
have no uneven sim, since lumps would not explain why gaits fall on flat ground."""

ENVELOPES_RAD = (0.02, 0.05)
"""Standard deviations [rad] of the noise on commands that ANE chooses from."""

ENVELOPE_WALKS = 12
"""Number of real walks by which ANE judges each standard deviation of its noise."""

OF_DATA, OF_SEARCH, OF_TRIALS, OF_ENVELOPES = range(4)
"""Numbers by which seeds are derived for different uses; all methods share the seeds,
so that differences between results come from the methods."""


@dataclass(frozen=True)
class Effort:
    """Numbers of walks and sizes of searches.

    Attributes:
      trials: number of real courses on which each gait that was found is tried.
      repeats: number of walks that rate a gait in a sim with random numbers.
      walks: numbers of real walks for the first grounding step, and for each further.
      sim_walks: number of walks in the sim for each grounding step.
      sim: size of a search in the sim.
      real: size of the search in the real world.
    """

    trials: int
    repeats: int
    walks: tuple[int, int]
    sim_walks: int
    sim: Budget
    real: Budget


class NaoStudy:
    """Computes the cells one by one: results of a method after a grounding step.

    Attributes:
      cells: all that are known so far, as plain values.
    """

    def __init__(
        self, folder: RunFolder, effort: Effort, places: Places, seed: int
    ) -> None:
        """Start a study, or continue the one that the run's folder holds.

        `places` has the real course, and the diagnosis that corrects the sim.
        """
        self._folder, self._effort, self._entropy = folder, effort, seed
        self._diagnosed, self._plain = places, Places(places.real)
        state = folder.read_json(HISTORY) if folder.has(HISTORY) else {CELLS: []}
        self.cells: list[dict[str, Any]] = state[CELLS]
        self._first = self._first_step(self._plain)
        self._first_diagnosed = self._first_step(places, self._first)

    def _first_step(
        self, places: Places, beside: GroundingStep | None = None
    ) -> GroundingStep:
        walks = self._effort.walks[0], self._effort.sim_walks
        return GroundingStep(
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
        """The result of a method after a grounding step; None if there is none yet."""
        for cell in self.cells:
            if (cell["method"], cell["step"]) == (method, step):
                return cell
        return None

    def compute(self, method: str, step: int) -> None:
        """Find a method's gait, try it in the real world, and write the result."""
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
        """A gait tuned in a grounded sim, and the number of real walks it took.

        All methods share the walks of step 1, since all begin at the same gait.
        """
        effort, start = self._effort, gaits.get("start")
        data, places = self._first, self._plain
        name = method.removesuffix(_ON_DIAGNOSED)
        if name != method:
            data, places = self._first_diagnosed, self._diagnosed
        walks = effort.walks[0]
        if step == 2:
            before = self.cell(method, 1)
            assert before is not None
            start = Gait.from_mapping(before["gait"])
            more = effort.walks[1], effort.sim_walks
            seed = self._seed(OF_DATA, step)
            cloud = GaitCloud.near(start)
            data = GroundingStep(start, cloud, more, seed, data, places)
            walks += effort.walks[1]
        repeats = effort.repeats if grounding(name).is_random else 1
        rater = data.rater(name, repeats)
        gait = self._tune(checkpoint, start, rater)
        return gait, {"real_walks": walks}

    def _best_envelope(self, checkpoint: Path) -> tuple[Gait, dict[str, Any]]:
        """The gait of ANE: of those tuned at each noise level, the best on real."""
        found = []
        for level in ENVELOPES_RAD:
            path = checkpoint.with_suffix(f".{1000 * level:.0f}mrad.pkl")
            envelope = GroundedSim(action_envelope(level))
            rater = GroundedRater(envelope, self._effort.repeats)
            gait = self._tune(path, gaits.get("start"), rater)
            score = self._try(gait, ENVELOPE_WALKS, OF_ENVELOPES)
            found.append((worth_cm_s(score), level, gait))
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
        outcome = evaluate(study, robots.get(ROBOT), {"gait": gait}, self._seed(use))
        score = asdict(outcome["gait"].score)
        return {
            "speed_mean": score["speed_cm_s"],
            "speed_std": score["speed_std"],
            "falls": score["falls"],
            "trials": score["trials"],
        }

    def _seed(self, *use: int) -> np.random.SeedSequence:
        return np.random.SeedSequence(self._entropy, spawn_key=use)
