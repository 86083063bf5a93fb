"""`groundwalk evaluate`: gaits walk a course of 3 m in one or both worlds."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import tyro

import robots
import worlds
from experiments.command_line import run_verb
from experiments.reports.tables import SCORE_HEADINGS, print_result, score_rows
from experiments.runs.extras import extra
from experiments.runs.folder import RESULT, open_run
from experiments.runs.gait_files import load_gaits
from experiments.runs.options import RunOptions
from experiments.seeing.run_pictures import picture_run
from experiments.seeing.score_page import write_page
from experiments.walking.evaluation import Study, evaluate, keep
from experiments.walking.trials import course
from groundwalk.errors import BadValueError

VERB = "evaluate"


@dataclass(frozen=True)
class Evaluate(RunOptions):
    """Let gaits walk straight ahead: speed with its spread, and falls.

    Attributes:
      gaits: names (`groundwalk list gaits`), .json files with a gait, or run folders of
        optimize-gait.
      worlds: the worlds to walk in: sim, real or both.
      terrain: the ground, such as "lumps:amplitude_m=0.008"; by default that of each
        world.
      robot: name of a robot (`groundwalk list robots`), or a .urdf or .toml file.
      trials: number of trials of each gait in each world, each on its own ground.
      threads: processor threads; 0 for all.
    """

    gaits: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    worlds: tuple[str, ...] = ("sim", "real")
    terrain: str | None = None
    robot: str = "nao"
    trials: int = 10
    course_m: float = 3.0
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        super().__post_init__()
        robots.get(self.robot)
        if not self.worlds or not (self.gaits or self.resume):
            raise BadValueError("no gaits or no worlds are given; at least one of each")
        load_gaits(self.gaits)
        for world in self.worlds:
            self.study(world)

    def study(self, world: str) -> Study:
        """Ground, trials and threads of the evaluation in a world, "sim" or "real"."""
        terrain = self.terrain or worlds.kind(world).terrain
        rules = course(self.course_m)
        return Study(world, terrain, self.trials, rules, threads=self.threads)


def main(config: Evaluate) -> None:
    """Evaluate the gaits in each world; a resumed run skips the worlds it has done."""
    folder, config = open_run(VERB, config)
    gaits = load_gaits(config.gaits)
    result = folder.read_json(RESULT) if folder.has(RESULT) else {}
    for world in config.worlds:
        if world in result:
            continue
        seed = np.random.SeedSequence([config.seed, worlds.kind(world).seed_key])
        outcomes = evaluate(config.study(world), robots.get(config.robot), gaits, seed)
        result[world] = keep(folder, world, outcomes)
        folder.write_json(RESULT, result)
    with extra("a picture of the walks"):
        picture_run(folder)
    title = f"How fast and how surely do these gaits walk {config.course_m:g} m?"
    write_page(folder, title, result)
    rows = score_rows(result)
    print_result(config.json, result, SCORE_HEADINGS, rows, folder.path)


if __name__ == "__main__":
    run_verb(Evaluate, main)
