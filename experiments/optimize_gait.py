"""`groundwalk optimize-gait`: CMA-ES tunes the 16 gait parameters in the sim."""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import robots
from experiments.command_line import run_verb
from experiments.reports.tables import SCORE_HEADINGS, print_result, score_rows
from experiments.runs.extras import extra
from experiments.runs.folder import RESULT, RunFolder, open_run
from experiments.runs.gait_files import load_gait, load_gaits
from experiments.runs.options import DefaultInt, RunOptions
from experiments.seeing.run_pictures import picture_run
from experiments.seeing.score_page import write_page
from experiments.walking.evaluation import Study, evaluate, keep
from experiments.walking.gait_search import SEARCH_VERB, SearchPlan, search_gait
from experiments.walking.trials import course
from walk_engine import Gait

WORLDS = ("sim", "real")
TITLE = "How does the gait that was tuned in the sim walk in both worlds?"


@dataclass(frozen=True)
class OptimizeGait(RunOptions):
    """Tune a gait with CMA-ES in the sim, then try it on real uneven ground.

    A run that was stopped is continued with --resume. With a larger number of
    --generations than before, --resume also extends a search that has ended: the
    result has the same bits as one long search.

    Attributes:
      robot: name of a robot (`groundwalk list robots`), or a .urdf or .toml file.
      start: the gait that the search starts from: a name, .json file or run folder.
      terrain: ground of the search in the sim, for example "lumps:amplitude_m=0.005".
      real_terrain: ground of the evaluation in the real world.
      sim: run folder of a diagnosis; its effects are added to the sim.
      population: number of gaits tried in each generation.
      generations: number of generations of the search.
      sigma: spread of the first generation, as a share of each parameter's range.
      ratings: number of times that the mean gait of each generation is rated after the
        search, to choose the best of them.
      trials: number of trials of each gait in each world.
      course_m: length of the trials' course [m].
      threads: processor threads; 0 for all.

    Example:
      See docs/python.md.
    """

    robot: str = "nao"
    start: str = "start"
    terrain: str = "flat"
    real_terrain: str = "lumps"
    sim: Path | None = None
    population: int = 150
    generations: int = DefaultInt(15)
    sigma: float = 0.15
    ratings: int = 10
    trials: int = 10
    course_m: float = 3.0
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        super().__post_init__()
        self.plan()
        for world in WORLDS:
            self.study(world)

    def plan(self) -> SearchPlan:
        """The search that these options ask for."""
        names = [field.name for field in dataclasses.fields(SearchPlan)]
        return SearchPlan(**{name: getattr(self, name) for name in names})

    def study(self, world: str) -> Study:
        """Ground and trials of the gaits' evaluation in a world, "sim" or "real"."""
        ground = dict(zip(WORLDS, (self.terrain, self.real_terrain), strict=True))
        correction = self.sim if world == "sim" else None
        return Study(
            world,
            ground[world],
            self.trials,
            course(self.course_m),
            threads=self.threads,
            correction=correction,
        )


def main(config: OptimizeGait) -> None:
    """Run the search and the evaluation, and print the scores."""
    folder, _ = tune_gait(config)
    result = folder.read_json(RESULT)
    rows = score_rows({world: result[world] for world in WORLDS})
    print_result(config.json, result, SCORE_HEADINGS, rows, folder.path)


def tune_gait(config: OptimizeGait) -> tuple[RunFolder, Gait]:
    """Tune a gait in the sim, and try it in both worlds.

    The results are the run's folder and the tuned gait.

    Example:
      >>> folder, gait = tune_gait(OptimizeGait(population=8, generations=2, trials=1))
      See docs/python.md.
    """
    folder, config = open_run(SEARCH_VERB, config, may_grow="generations")
    tuned = search_gait(config.plan(), folder)
    if not folder.has(RESULT):
        table = _evaluate(config, folder, tuned)
        folder.write_json(RESULT, {**table, "gait": dict(tuned)})
    result = folder.read_json(RESULT)
    with extra("a picture of the walks"):
        picture_run(folder)
    scores = {world: result[world] for world in WORLDS}
    write_page(folder, TITLE, scores, load_gaits([config.start]))
    return folder, Gait.from_mapping(result["gait"])


def _evaluate(config: OptimizeGait, folder: RunFolder, tuned: Gait) -> dict[str, Any]:
    """Evaluate start gait and tuned gait in both worlds."""
    description = robots.get(config.robot)
    both = {"start": load_gait(config.start), "tuned": tuned}
    *_, of_trials = config.plan().seeds()
    table = {}
    for world, own in zip(WORLDS, of_trials.spawn(2), strict=True):
        outcomes = evaluate(config.study(world), description, both, own)
        table[world] = keep(folder, world, outcomes)
    return table


if __name__ == "__main__":
    run_verb(OptimizeGait, main)
