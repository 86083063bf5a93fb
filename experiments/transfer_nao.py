"""`groundwalk transfer nao`: gaits tuned in grounded sims, tried on uneven ground."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import robots
import worlds
from experiments.command_line import run_verb
from experiments.evaluation import Study, evaluate
from experiments.grounded_sim import ROBOT, GroundedSim
from experiments.progress import progress
from experiments.run_folder import HISTORY, RESULT, RunFolder, open_run
from experiments.score_table import print_json
from experiments.search import check_search
from experiments.text_table import print_table
from experiments.transfer_nao_figure import FIGURE, draw_cells
from experiments.transfer_nao_page import CELLS, HEADINGS, table_of, write_nao_page
from experiments.walk_data import GaitCloud
from experiments.walk_groundings import (
    GAT,
    NONE,
    SGAT,
    UNEVEN,
    action_envelope,
)
from experiments.walk_raters import GroundedRater, RandomisedRater, Rater, RealRater
from experiments.walk_tuning import Budget, Grounding, cloud_around, tune
from groundwalk.errors import BadValueError, UnknownNameError
from walk_engine import Gait, gaits

VERB = "transfer-nao"
START, ANE, RANDOMISED, REAL = "start gait", "ANE", "randomisation", "search on real"
PLAN = (
    (START, 0),
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

METHODS = tuple(dict.fromkeys(method for method, _ in PLAN[1:]))

ENVELOPES_RAD = (0.02, 0.05)
ENVELOPE_WALKS = 12
OF_DATA, OF_SEARCH, OF_TRIALS, OF_ENVELOPES = range(4)
SMALLEST = {"trials": 2, "generations": 1, "repeats": 1, "real_walks": 2,
            "more_real_walks": 2, "sim_walks": 2, "real_generations": 1}  # fmt: skip


@dataclass(frozen=True)
class TransferNao:
    """Tune gaits in grounded sims, and count falls on real uneven ground.

    Attributes:
      methods: to compare; the start gait is always tried.
      trials: of each gait found, on a course of 3 m.
      population: gaits in a generation.
      generations: of a search in the sim.
      sigma: spread of the first generation, as a part of each parameter's range.
      repeats: walks of each gait in a stochastic sim.
      real_walks: that the first grounding step learns from.
      more_real_walks: that each further step learns from.
      sim_walks: that each grounding step learns from.
      real_population: gaits in a generation of the search on real.
      real_generations: of the search on real.
      seed: every random number follows from it.
      out: the run's folder; a new one under runs/ by default.
      resume: continue the run of this folder.
      json: print the result as JSON.
    """

    methods: tuple[str, ...] = METHODS
    trials: int = 40
    population: int = 150
    generations: int = 10
    sigma: float = 0.15
    repeats: int = 2
    real_walks: int = 96
    more_real_walks: int = 48
    sim_walks: int = 200
    real_population: int = 50
    real_generations: int = 10
    seed: int = 1
    out: Path | None = None
    resume: Path | None = None
    json: bool = False

    def __post_init__(self) -> None:
        """Refuse what no run can do, before anything is written."""
        for method in self.methods:
            if method not in METHODS:
                raise UnknownNameError("method", method, METHODS)
        check_search(self.population, self.sigma)
        check_search(self.real_population, self.sigma)
        for name, least in SMALLEST.items():
            if getattr(self, name) < least:
                raise BadValueError(
                    f"{name} is {getattr(self, name)}; give at least {least}"
                )
        if self.seed < 0:
            raise BadValueError(f"seed is {self.seed}; it must not be negative")

    @property
    def plan(self) -> tuple[tuple[str, int], ...]:
        """Method and step of the cells that are asked for."""
        return tuple(cell for cell in PLAN if cell[0] in (START, *self.methods))

    @property
    def budget(self) -> Budget:
        """Of searches in the sim."""
        return Budget(self.population, self.generations, self.sigma)

    @property
    def real_budget(self) -> Budget:
        """Of the search on real."""
        return Budget(self.real_population, self.real_generations, self.sigma)


def main(config: TransferNao) -> None:
    """Find every cell's gait and try it; what is done is not done again."""
    folder, config = open_run(VERB, config)
    study = _Study(config, folder)
    if study.cells:
        _write(folder, config, study.cells)
    with progress("ways to a gait", len(config.plan), done=len(study.cells)) as bar:
        for method, step in config.plan:
            if study.cell(method, step) is None:
                study.compute(method, step)
                bar.advance(f"{method}, step {step} done")
                _write(folder, config, study.cells)
    if config.json:
        print_json({CELLS: study.cells})
    else:
        print_table(HEADINGS, table_of(study.cells))
        print(f"everything else is in {folder.path}")


def _write(
    folder: RunFolder, config: TransferNao, cells: Sequence[Mapping[str, Any]]
) -> None:
    """Write down what is known so far: a study takes hours."""
    folder.write_json(RESULT, {CELLS: cells})
    draw_cells(cells, folder.path / FIGURE)
    write_nao_page(folder, cells, len(config.plan))


class _Study:
    """The cells so far, and the groundings that several of them share."""

    def __init__(self, config: TransferNao, folder: RunFolder) -> None:
        self._config, self._folder = config, folder
        state = folder.read_json(HISTORY) if folder.has(HISTORY) else {CELLS: []}
        self.cells: list[dict[str, Any]] = state[CELLS]
        walks = config.real_walks, config.sim_walks
        start = gaits.get("start")
        self._first = Grounding(start, GaitCloud(), walks, self._seed(OF_DATA))

    def cell(self, method: str, step: int) -> Mapping[str, Any] | None:
        """What is known of a cell."""
        for cell in self.cells:
            if (cell["method"], cell["step"]) == (method, step):
                return cell
        return None

    def compute(self, method: str, step: int) -> None:
        """Find the cell's gait, try it on real, and write the cell down."""
        gait, facts = self._find(method, step)
        score = self._try(gait, self._config.trials, OF_TRIALS)
        cell = {"method": method, "step": step, **score, **facts, "gait": dict(gait)}
        self.cells.append(cell)
        self._folder.write_json(HISTORY, {CELLS: self.cells})

    def _find(self, method: str, step: int) -> tuple[Gait, dict[str, Any]]:
        config, start = self._config, gaits.get("start")
        checkpoint = self._folder.path / f"search_{method}_{step}.pkl".replace(" ", "_")
        if method == START:
            return start, {"real_walks": 0}
        if method == ANE:
            return self._best_envelope(checkpoint)
        if method == REAL:
            budget = config.real_budget
            gait = self._tune(checkpoint, start, RealRater(), budget)
            return gait, {"real_walks": budget.population * budget.generations}
        if method == RANDOMISED:
            rater: Rater = RandomisedRater(config.repeats)
            return self._tune(checkpoint, start, rater), {"real_walks": 0}
        if method == NONE:
            rater = GroundedRater(GroundedSim(), 1)
            return self._tune(checkpoint, start, rater), {"real_walks": 0}
        return self._grounded(checkpoint, method, step)

    def _grounded(
        self, checkpoint: Path, method: str, step: int
    ) -> tuple[Gait, dict[str, Any]]:
        """Step 1 shares its data, as all methods begin at the start gait."""
        config = self._config
        start, grounding = gaits.get("start"), self._first
        walks = config.real_walks
        if step == 2:
            before = self.cell(method, 1)
            assert before is not None
            start = Gait.from_mapping(before["gait"])
            more = config.more_real_walks, config.sim_walks
            seed = self._seed(OF_DATA, step)
            grounding = Grounding(
                start, cloud_around(start), more, seed, before=self._first
            )
            walks += config.more_real_walks
        rater = grounding.rater(method, 1 if method == GAT else config.repeats)
        gait = self._tune(checkpoint, start, rater)
        return gait, {"real_walks": walks}

    def _best_envelope(self, checkpoint: Path) -> tuple[Gait, dict[str, Any]]:
        """The coarse grid of ANE: the noise whose gait earns most on real."""
        found = []
        for level in ENVELOPES_RAD:
            path = checkpoint.with_suffix(f".{1000 * level:.0f}mrad.pkl")
            envelope = GroundedSim(action_envelope(level))
            rater = GroundedRater(envelope, self._config.repeats)
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
        budget = budget or self._config.budget
        return tune(checkpoint, start, budget, rater, self._seed(OF_SEARCH))

    def _try(self, gait: Gait, trials: int, use: int) -> dict[str, Any]:
        study = Study("real", worlds.kind("real").terrain, trials)
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
        return np.random.SeedSequence(self._config.seed, spawn_key=use)


if __name__ == "__main__":
    run_verb(TransferNao, main)
