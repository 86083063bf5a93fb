"""The cells of the NAO study: ways to find a gait, each tried in the real world.

A cell is one method after one grounding step. To try another grounding of
`sgat.transformers`, add its title to `PLAN`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import robots
import worlds
from experiments.grounded_walks.courses import Places, RealCourse
from experiments.grounded_walks.models import (
    GAT,
    NONE,
    SGAT,
    UNEVEN,
    GroundingStep,
    action_envelope,
)
from experiments.grounded_walks.walks import (
    ROBOT,
    WALK,
    GroundedSim,
    rate_in_sim,
    rate_on_real,
    rate_randomised,
)
from experiments.runs.folder import HISTORY, RunFolder
from experiments.runs.options import RunOptions, check_at_least
from experiments.transfer.nao_studies.page import (
    CELLS,
    DIAGNOSED,
    DIAGNOSED_SIM,
    worth_cm_s,
)
from experiments.walking.evaluation import Study, check_correction, evaluate
from experiments.walking.search import RATINGS, Budget, Rater, check_search, tune
from experiments.walking.trials import course
from groundwalk.errors import BadValueError, UnknownNameError
from sgat.transformers.catalogue import grounding
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import Gait, gaits
from worlds.hidden.effects import Hidden
from worlds.real.hidden_robot import check_hidden

START_GAIT = gaits.get("start")
START, ANE, RANDOMISED, REAL = "start gait", "ANE", "randomisation", "search on real"
"""Methods without a grounding: the gait that all searches start from; searches in the
sim with the action noise envelope (ANE), with random dynamics, and in the real
world."""

_ON_DIAGNOSED = f", {DIAGNOSED}"
DIAGNOSED_UNEVEN, DIAGNOSED_SGAT = UNEVEN + _ON_DIAGNOSED, SGAT + _ON_DIAGNOSED
"""Methods that ground a sim which a diagnosis has corrected."""

PLAN = (
    (START, 0), (DIAGNOSED_SIM, 1), (DIAGNOSED_UNEVEN, 1), (DIAGNOSED_UNEVEN, 2),
    (DIAGNOSED_SGAT, 1), (DIAGNOSED_SGAT, 2), (UNEVEN, 1), (UNEVEN, 2), (SGAT, 1),
    (GAT, 1), (SGAT, 2), (GAT, 2), (NONE, 1), (RANDOMISED, 1), (ANE, 1), (REAL, 1),
)  # fmt: skip
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

SMALLEST = {"trials": 2, "generations": 1, "ratings": 1, "repeats": 1, "real_walks": 2,
            "more_real_walks": 2, "sim_walks": 2, "real_generations": 1}  # fmt: skip
"""Least value of each option with which the study can run."""

ENVELOPES_RAD = (0.02, 0.05)
"""Standard deviations [rad] of the noise on commands that the action noise envelope
(ANE) chooses from."""

ENVELOPE_WALKS = 12
"""Number of real walks by which the action noise envelope (ANE) judges each of its
standard deviations."""

OF_DATA, OF_SEARCH, OF_TRIALS, OF_ENVELOPES = range(4)
"""Numbers by which seeds are derived for different uses; all methods share the seeds,
so that differences between results come from the methods."""


@dataclass(frozen=True)
class TransferNao(RunOptions):
    """Tune gaits in grounded sims, and count falls on real uneven ground.

    Attributes:
      methods: methods to compare; the start gait is always tried.
      terrain: ground of the real world's courses.
      hidden: physics of the real world that the sim's model lacks, such as
        speed_limit@LKneePitch:speed=3.
      sim: folder of a diagnosis of the real robot; the sim that it corrects is tried
        beside the plain one.
      trials: number of real courses on which each gait that was found is tried.
      course_m: length of these courses [m].
      population: number of gaits in a generation of a search in the sim.
      generations: number of generations of a search in the sim.
      sigma: standard deviation of the first generation, as a share of each parameter's
        range.
      ratings: number of times that the mean gait of each generation is rated after a
        search, to choose the best of them.
      repeats: number of walks that rate a gait in a sim with random numbers.
      real_walks: number of real walks that the first grounding step learns from.
      more_real_walks: number of real walks that each further step adds.
      sim_walks: number of walks in the sim for each grounding step.
      real_population: number of gaits in a generation of the search in the real world.
      real_generations: number of generations of the search in the real world.
    """

    methods: tuple[str, ...] | None = None
    terrain: str = worlds.kind("real").terrain
    hidden: tuple[str, ...] = ()
    sim: Path | None = None
    trials: int = 40
    course_m: float = 3.0
    population: int = 150
    generations: int = 10
    sigma: float = 0.15
    ratings: int = RATINGS
    repeats: int = 2
    real_walks: int = 96
    more_real_walks: int = 48
    sim_walks: int = 200
    real_population: int = 50
    real_generations: int = 10

    def __post_init__(self) -> None:
        """Refuse options with which nothing can run, before anything is written."""
        known = tuple(dict.fromkeys((*METHODS, *WITH_SIM, *WITH_SIM_ON_FLAT)))
        for method in self.compared:
            if method not in known:
                raise UnknownNameError("method", method, known)
            if self.sim is None and method not in METHODS:
                raise BadValueError(f"{method!r} needs a diagnosis: give --sim")
        robot, places = robots.get(ROBOT), self.places
        check_hidden(robot, places.real.options)
        if self.sim is not None:
            check_correction(robot, worlds.kind("sim").options, self.sim)
        check_search(self.population, self.sigma)
        check_search(self.real_population, self.sigma)
        check_at_least(self, **SMALLEST)
        self.study(self.trials)
        super().__post_init__()

    @property
    def compared(self) -> tuple[str, ...]:
        """The methods to compare; a default set if none are given."""
        if self.methods is not None:
            return self.methods
        if self.sim is None:
            return METHODS
        return WITH_SIM_ON_FLAT if self.places.real.flat else WITH_SIM

    @property
    def plan(self) -> tuple[tuple[str, int], ...]:
        """Method and grounding step of each gait to find and try."""
        return tuple(cell for cell in PLAN if cell[0] in (START, *self.compared))

    @property
    def places(self) -> Places:
        """The real course, and the diagnosis that corrects the sim."""
        hidden = tuple(Hidden.parse(text) for text in self.hidden)
        return Places(RealCourse(self.terrain, hidden, self.course_m), self.sim)

    def study(self, trials: int) -> Study:
        """The evaluation of a gait in the real world."""
        real = self.places.real
        rules = course(real.length_m)
        return Study("real", real.terrain, trials, rules, hidden=real.hidden)


class NaoStudy:
    """Computes the cells one by one: results of a method after a grounding step.

    Attributes:
      cells: all that are known so far, as plain values.
    """

    def __init__(self, folder: RunFolder, config: TransferNao) -> None:
        """Start a study, or continue the one that the run's folder holds."""
        self._folder, self._config = folder, config
        self._diagnosed, self._plain = config.places, Places(config.places.real)
        state = folder.read_json(HISTORY) if folder.has(HISTORY) else {CELLS: []}
        self.cells: list[dict[str, Any]] = state[CELLS]
        self._first = self._first_step(self._plain)
        self._first_diagnosed = self._first_step(self._diagnosed, self._first)

    def _first_step(
        self, places: Places, beside: GroundingStep | None = None
    ) -> GroundingStep:
        walks = self._config.real_walks, self._config.sim_walks
        seed = self._seed(OF_DATA)
        return GroundingStep(
            START_GAIT, GaitCloud(), walks, seed, places=places, beside=beside
        )

    def cell(self, method: str, step: int) -> Mapping[str, Any] | None:
        """The result of a method after a grounding step; None if there is none yet."""
        for cell in self.cells:
            if (cell["method"], cell["step"]) == (method, step):
                return cell
        return None

    def compute(self, method: str, step: int) -> None:
        """Find a method's gait, try it in the real world, and write the result."""
        gait, facts = self._find(method, step)
        score = self._try(gait, self._config.trials, OF_TRIALS)
        cell = {"method": method, "step": step, **score, **facts, "gait": dict(gait)}
        self.cells.append(cell)
        self._folder.write_json(HISTORY, {CELLS: self.cells})

    def _find(self, method: str, step: int) -> tuple[Gait, dict[str, Any]]:
        """The gait of a method, and the number of real walks that it took."""
        config = self._config
        checkpoint = self._folder.path / f"search_{method}_{step}.json".replace(
            " ", "_"
        )
        if method == START:
            return START_GAIT, {"real_walks": 0}
        if method == ANE:
            return self._best_envelope(checkpoint)
        if method == REAL:
            budget = Budget(
                config.real_population,
                config.real_generations,
                config.sigma,
                config.ratings,
            )
            rater: Rater = partial(rate_on_real, self._plain.real)
            gait = self._tune(checkpoint, START_GAIT, rater, budget)
            return gait, {"real_walks": budget.rated}
        if method not in (RANDOMISED, NONE, DIAGNOSED_SIM):
            return self._grounded(checkpoint, method, step)
        if method == RANDOMISED:
            rater = partial(rate_randomised, config.repeats)
        else:
            places = self._plain if method == NONE else self._diagnosed
            rater = partial(rate_in_sim, GroundedSim(None, places.sim()), 1, WALK)
        return self._tune(checkpoint, START_GAIT, rater), {"real_walks": 0}

    def _grounded(
        self, checkpoint: Path, method: str, step: int
    ) -> tuple[Gait, dict[str, Any]]:
        """A gait tuned in a grounded sim, and the number of real walks it took.

        All methods share the walks of step 1, since all begin at the same gait.
        """
        config, start = self._config, START_GAIT
        data, places = self._first, self._plain
        name = method.removesuffix(_ON_DIAGNOSED)
        if name != method:
            data, places = self._first_diagnosed, self._diagnosed
        walks = config.real_walks
        if step == 2:
            before = self.cell(method, 1)
            assert before is not None
            start = Gait.from_mapping(before["gait"])
            more = config.more_real_walks, config.sim_walks
            seed = self._seed(OF_DATA, step)
            cloud = GaitCloud.near(start)
            data = GroundingStep(start, cloud, more, seed, data, places)
            walks += config.more_real_walks
        repeats = config.repeats if grounding(name).is_random else 1
        gait = self._tune(checkpoint, start, data.rater(name, repeats))
        return gait, {"real_walks": walks}

    def _best_envelope(self, checkpoint: Path) -> tuple[Gait, dict[str, Any]]:
        """The gait by action noise envelope: of all noise levels the best on real."""
        found = []
        for level in ENVELOPES_RAD:
            path = checkpoint.with_suffix(f".{1000 * level:.0f}mrad.json")
            sim = GroundedSim(action_envelope(level))
            rater = partial(rate_in_sim, sim, self._config.repeats, WALK)
            gait = self._tune(path, START_GAIT, rater)
            score = self._try(gait, ENVELOPE_WALKS, OF_ENVELOPES)
            found.append((worth_cm_s(score), level, gait))
        _, level, gait = max(found, key=lambda entry: entry[:2])
        walks = ENVELOPE_WALKS * len(found)
        return gait, {"real_walks": walks, "envelope_rad": level}

    def _tune(
        self, checkpoint: Path, start: Gait, rater: Rater, budget: Budget | None = None
    ) -> Gait:
        config = self._config
        if budget is None:
            budget = Budget(
                config.population, config.generations, config.sigma, config.ratings
            )
        return tune(checkpoint, start, budget, rater, self._seed(OF_SEARCH))

    def _try(self, gait: Gait, trials: int, use: int) -> dict[str, Any]:
        study = self._config.study(trials)
        outcome = evaluate(study, robots.get(ROBOT), {"gait": gait}, self._seed(use))
        score = outcome["gait"].score
        return {
            "speed_mean": score.speed_cm_s,
            "speed_std": score.speed_std,
            "falls": score.falls,
            "trials": score.trials,
        }

    def _seed(self, *use: int) -> np.random.SeedSequence:
        return np.random.SeedSequence(self._config.seed, spawn_key=use)
