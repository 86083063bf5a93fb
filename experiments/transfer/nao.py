"""`groundwalk transfer nao`: tune gaits in grounded sims, try them on uneven ground."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import robots
import worlds
from experiments.command_line import run_verb
from experiments.grounded_walks.courses import Places, RealCourse
from experiments.grounded_walks.sim import ROBOT
from experiments.runs.folder import RESULT, RunFolder, open_run
from experiments.runs.options import RunOptions, check_at_least
from experiments.runs.progress import progress
from experiments.transfer.claims import print_study, write_picture
from experiments.transfer.nao_studies.figure import FIGURE, cells_figure
from experiments.transfer.nao_studies.page import (
    CELLS,
    HEADINGS,
    table_of,
    write_nao_page,
)
from experiments.transfer.nao_studies.study import (
    METHODS,
    PLAN,
    START,
    WITH_SIM,
    WITH_SIM_ON_FLAT,
    Effort,
    NaoStudy,
)
from experiments.walking.search import check_search
from experiments.walking.sims import check_correction
from experiments.walking.tuning import Budget
from groundwalk.errors import BadValueError, UnknownNameError
from worlds.hidden.effects import Hidden
from worlds.real.hidden_robot import check_hidden

VERB = "transfer-nao"
SMALLEST = {"trials": 2, "generations": 1, "repeats": 1, "real_walks": 2,
            "more_real_walks": 2, "sim_walks": 2, "real_generations": 1}  # fmt: skip
"""Least value of each option with which the study can run."""


@dataclass(frozen=True)
class TransferNao(RunOptions):
    """Tune gaits in grounded sims, and count falls on real uneven ground.

    Attributes:
      methods: methods to compare; the start gait is always tried.
      terrain: ground of the real world's courses, which are 3 m long.
      hidden: physics of the real world that the sim's model lacks, such as
        speed_limit@LKneePitch:speed=3.
      sim: folder of a diagnosis of the real robot; the sim that it corrects is tried
        beside the plain one.
      trials: number of real courses on which each gait that was found is tried.
      population: number of gaits in a generation of a search in the sim.
      generations: number of generations of a search in the sim.
      sigma: standard deviation of the first generation, as a share of each parameter's
        range.
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
    population: int = 150
    generations: int = 10
    sigma: float = 0.15
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
        return Places(RealCourse(self.terrain, hidden), self.sim)

    @property
    def effort(self) -> Effort:
        """The numbers of walks and the sizes of searches."""
        return Effort(
            self.trials,
            self.repeats,
            (self.real_walks, self.more_real_walks),
            self.sim_walks,
            Budget(self.population, self.generations, self.sigma),
            Budget(self.real_population, self.real_generations, self.sigma),
        )


def main(config: TransferNao) -> None:
    """Find and try a gait by every method; results of an earlier run are kept."""
    folder, config = open_run(VERB, config)
    study = NaoStudy(folder, config.effort, config.places, config.seed)
    if study.cells:
        _write(folder, config, study.cells)
    with progress("ways to a gait", len(config.plan), done=len(study.cells)) as bar:
        for method, step in config.plan:
            if study.cell(method, step) is None:
                study.compute(method, step)
                bar.advance(f"{method}, step {step} done")
                _write(folder, config, study.cells)
    result, table = {CELLS: study.cells}, table_of(study.cells)
    print_study(config.json, folder, result, HEADINGS, table)


def _write(
    folder: RunFolder, config: TransferNao, cells: Sequence[Mapping[str, Any]]
) -> None:
    """Write the results so far, since a study takes hours."""
    folder.write_json(RESULT, {CELLS: cells})
    write_picture(folder, FIGURE, cells_figure, cells)
    write_nao_page(folder, cells, len(config.plan), config.places.real)


if __name__ == "__main__":
    run_verb(TransferNao, main)
