"""`groundwalk humanoids`: tune a gait for other humanoid robots than the NAO."""

import contextlib
import dataclasses
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import robots
from experiments.command_line import run_verb
from experiments.humanoid_study.facts import reach, saturation, sole
from experiments.humanoid_study.page import (
    PICTURE,
    draw_humanoids,
    robot_rows,
    write_humanoids_page,
)
from experiments.reports.tables import print_result
from experiments.runs.extras import extra
from experiments.runs.folder import CHECKPOINT, RECORDINGS, RESULT, RunFolder, open_run
from experiments.runs.gait_files import short_name
from experiments.runs.options import RunOptions, check_at_least
from experiments.seeing.run_pictures import picture_run
from experiments.walking.evaluation import Study, evaluate, keep
from experiments.walking.search import RATINGS, Budget, check_search, tune
from experiments.walking.trials import TrialRules, reward_cm_s, walk_trials
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from robots import Description
from terrain import TerrainSpec, parse
from walk_engine import gaits
from worlds import read_recording

VERB = "humanoids"
WALK = TrialRules(limit_s=5.0, start_spread_rad=0.01)
"""Rules of the walks whose falls are counted: at most 5 s; the joint angles of the
start poses have a standard deviation of 0.01 rad."""

SEARCHED = TrialRules(limit_s=5.0, start_spread_rad=0.02)
"""Rules of the walks in a search: at most 5 s. The start poses spread more (0.02 rad)
than in the final count of falls: a search sees only a few walks of each gait."""

START = gaits.get("start").replace(max_forward=0.12)
"""Gait from which every search starts: the NAO's start gait, slowed down to 0.12 m/s
because that gait is not made for these robots."""

WALKS = 3
"""Number of walks that rate a gait in the search, each from another start pose,
because a single walk may be luck."""

FALL_PENALTY_CM_S = 60.0
"""Penalty of a fall in the reward [cm/s], for a robot of the NAO's size: more than the
speed of the fastest walk, so that the search prefers a slow gait to one that falls."""


@dataclass(frozen=True)
class Humanoids(RunOptions):
    """Tune a gait for each robot in the sim, and count its falls in walks of 5 s.

    Attributes:
      robots: names (`groundwalk list robots`), or .urdf or .toml files.
      population: number of gaits tried in each generation.
      generations: number of generations of each search.
      sigma: spread of the first generation, as a share of each parameter's range.
      ratings: number of times that the mean gait of each generation is rated after a
        search, to choose the best of them.
      trials: number of walks in the sim that are counted, each from its own start pose.
      real_trials: number of walks in the real world, each on its own lumpy ground.
      threads: processor threads; 0 for all.
    """

    robots: tuple[str, ...] = (
        "talos", "g1", "romeo", "icub", "simple_humanoid", "simple_humanoid_as_is"
    )  # fmt: skip
    population: int = 20
    generations: int = 10
    sigma: float = 0.1
    ratings: int = RATINGS
    trials: int = 30
    real_trials: int = 10
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse invalid options before anything is written."""
        for name in self.robots:
            robots.get(name)
        if not self.robots or len({*map(short_name, self.robots)}) < len(self.robots):
            raise BadValueError("name at least one robot, and none of them twice")
        check_search(self.population, self.sigma)
        self.studies()
        check_at_least(self, generations=1, ratings=1)
        super().__post_init__()

    def studies(self) -> dict[str, Study]:
        """Ground, trials and rules of a tuned gait's evaluation, by world."""
        return {
            "sim": Study("sim", "flat", self.trials, WALK, self.threads),
            "real": Study("real", "lumps", self.real_trials, WALK, self.threads),
        }


def main(config: Humanoids) -> None:
    """Tune and evaluate each robot; a resumed run skips the robots it has done."""
    folder, config = open_run(VERB, config)
    result: dict[str, Any] = folder.read_json(RESULT) if folder.has(RESULT) else {}
    for name in config.robots:
        if name not in result:
            own = RunFolder(folder.path / short_name(name))
            result[name] = _robot(config, own, robots.get(name))
            folder.write_json(RESULT, result)
            with extra(f"{own.path}: a picture"):
                picture_run(own)
    with extra(PICTURE):
        walk = Path(RECORDINGS, "sim_tuned.parquet")  # the first in the sim
        names = [short_name(name) for name in config.robots]
        walks = {name: read_recording(folder.path / name / walk) for name in names}
        draw_humanoids(walks, folder.path / PICTURE)
    write_humanoids_page(folder, result)
    print_result(config.json, result, *robot_rows(result), folder.path)


def _robot(
    config: Humanoids, folder: RunFolder, description: Description
) -> dict[str, Any]:
    """Tune one robot's gait and evaluate it; return the measures as JSON values."""
    # The seed follows from the name: the other robots of the run make no difference.
    own = [config.seed, *description.name.encode()]
    of_search, of_trials = np.random.SeedSequence(own).spawn(2)
    budget = Budget(config.population, config.generations, config.sigma, config.ratings)
    rater = partial(_rate, config, description)
    tuned = tune(folder.path / CHECKPOINT, START, budget, rater, of_search)
    of_world = dict(zip(config.studies(), of_trials.spawn(2), strict=True))
    scores: dict[str, Any] = {}
    for world, study in config.studies().items():
        tried = {"start": START, "tuned": tuned}
        outcomes = evaluate(study, description, tried, of_world[world])
        scores[world] = keep(folder, world, outcomes)
        if world == "sim":
            limits = saturation(description, outcomes["tuned"].recording)
    return {
        "mass_kg": description.mass_kg,
        "scale": dataclasses.asdict(description.scale),
        **scores,
        "sole": sole(description),
        "reach": reach(description, tuned),
        "saturation": limits,
        "gait": dict(tuned),
    }


def _rate(
    config: Humanoids,
    description: Description,
    tried: FloatArray,
    seed: np.random.SeedSequence,
) -> FloatArray:
    """Mean rewards (n,) [cm/s] of n gaits (n, 16), over `WALKS` walks of each."""
    study = config.studies()["sim"]
    # The same poses for all gaits, so that only the gaits make a difference.
    poses = seed.spawn(WALKS) * len(tried)
    grounds = [TerrainSpec(*parse(study.terrain)).make()] * len(poses)
    world = study.make_world(description, grounds, poses)
    with contextlib.closing(world):
        trials = walk_trials(world, np.repeat(tried, WALKS, axis=0), SEARCHED, poses)
    penalty = FALL_PENALTY_CM_S * description.scale.speed
    rewards = reward_cm_s(trials, SEARCHED.limit_s, penalty)
    return np.asarray(rewards.reshape(len(tried), WALKS).mean(axis=1))


if __name__ == "__main__":
    run_verb(Humanoids, main)
