"""`groundwalk optimize-gait`: CMA-ES tunes the 16 gait parameters in the sim."""

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import robots
from experiments.command_line import run_verb
from experiments.reports.tables import (
    SCORE_HEADINGS,
    print_folder,
    print_json,
    print_table,
    score_rows,
)
from experiments.runs.extras import extra
from experiments.runs.folder import (
    CHECKPOINT,
    HISTORY,
    RESULT,
    RunFolder,
    open_run,
)
from experiments.runs.gait_files import load_gait
from experiments.runs.options import RunOptions, check_at_least
from experiments.seeing.run_pictures import picture_run
from experiments.seeing.score_page import write_page
from experiments.walking.evaluation import Study, evaluate, keep
from experiments.walking.recorder import Recorder
from experiments.walking.reward import FALL_PENALTY_CM_S, reward_cm_s
from experiments.walking.search import GaitSearch, check_search
from experiments.walking.search_run import RATINGS, best_mean, run_search
from experiments.walking.sims import check_correction, make_sim
from experiments.walking.trials import SEARCH_TRIAL, TrialRules, Trials, walk_trials
from groundwalk.arrays import FloatArray
from terrain import Heightfield, TerrainSpec, parse
from walk_engine import Gait

VERB = "optimize-gait"
WORLDS = ("sim", "real")
RATED = replace(SEARCH_TRIAL, start_spread_rad=0.01)
"""How a mean gait walks after the search: from a start pose that spreads, so that what
walks by luck alone does not win."""

TITLE = "How does the gait that was tuned in the sim walk in both worlds?"


@dataclass(frozen=True)
class OptimizeGait(RunOptions):
    """Tune a gait with CMA-ES in the sim, then try it on real uneven ground.

    Attributes:
      robot: its name, as `groundwalk list robots` shows them, or a URDF (.urdf).
      start: name or JSON file of the gait that the search starts from.
      terrain: ground of the search in the sim, for example "lumps:amplitude_m=0.005".
      real_terrain: ground of the evaluation in the real world.
      sim: folder of a diagnosis; the sim then has the physics that it found missing.
      population: gaits tried in each generation.
      generations: how many generations the search runs.
      sigma: spread of the first generation, as a part of each parameter's range.
      trials: of each gait in each world, on a course of 3 m.
      threads: processor threads; 0 for all.
    """

    robot: str = "nao"
    start: str = "start"
    terrain: str = "flat"
    real_terrain: str = "lumps"
    sim: Path | None = None
    population: int = 150
    generations: int = 15
    sigma: float = 0.15
    trials: int = 10
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse what no run can do, before anything is written."""
        description = robots.get(self.robot)
        if self.sim is not None:
            check_correction(description, self.study("sim").options, self.sim)
        load_gait(self.start)
        check_search(self.population, self.sigma)
        for world in WORLDS:
            self.study(world)
        check_at_least(self, generations=1)
        super().__post_init__()

    def study(self, world: str) -> Study:
        """How start and tuned gait are evaluated in a world."""
        ground = dict(zip(WORLDS, (self.terrain, self.real_terrain), strict=True))
        correction = self.sim if world == "sim" else None
        return Study(
            world,
            ground[world],
            self.trials,
            threads=self.threads,
            correction=correction,
        )


def main(config: OptimizeGait) -> None:
    """Run the search and the evaluation, and say what came of it."""
    folder, _ = tune_gait(config)
    result = folder.read_json(RESULT)
    if config.json:
        print_json(result)
    else:
        scores = {world: result[world] for world in WORLDS}
        print_table(SCORE_HEADINGS, score_rows(scores))
        print_folder(folder.path)


def tune_gait(config: OptimizeGait) -> tuple[RunFolder, Gait]:
    """Tune a gait and try it, for Python as for the command line.

    Args:
      config: what is tuned, and how.

    Returns:
      The run's folder, with everything in it, and the gait.

    Raises:
      GroundwalkError: the folder is in the way, or cannot be continued.
    """
    folder, config = open_run(VERB, config)
    tuned = search(config, folder)
    if not folder.has(RESULT):
        table = _evaluate(config, folder, tuned)
        folder.write_json(RESULT, {**table, "gait": dict(tuned)})
    result = folder.read_json(RESULT)
    with extra("a picture of the walks"):
        picture_run(folder)
    write_page(folder, TITLE, {world: result[world] for world in WORLDS})
    return folder, Gait.from_mapping(result["gait"])


def search(config: OptimizeGait, folder: RunFolder) -> Gait:
    """The search's answer, generation by generation with checkpoints."""
    of_samples, *_ = _seeds(config)
    grounds = search_grounds(config, config.generations)

    def begin() -> GaitSearch:
        start = load_gait(config.start)
        return GaitSearch(start, config.population, config.sigma, of_samples)

    means = run_search(
        folder.path / CHECKPOINT,
        begin,
        lambda number, strategy: _generation(config, strategy, grounds[number].make()),
        config.generations,
        lambda entries: folder.write_json(HISTORY, {"generations": entries}),
    )
    return best_mean(means, _ratings(config, means))


def search_grounds(config: OptimizeGait, generations: int) -> list[TerrainSpec]:
    """The ground of each generation, from the first one on."""
    _, of_grounds, *_ = _seeds(config)
    seeds = of_grounds.generate_state(generations).tolist()
    return [TerrainSpec(*parse(config.terrain), seed=seed) for seed in seeds]


def rate(
    config: OptimizeGait,
    tried: Sequence[Gait] | FloatArray,
    grounds: Sequence[Heightfield],
    poses: Sequence[np.random.SeedSequence] = (),
    rules: TrialRules = SEARCH_TRIAL,
    recorder: Recorder | None = None,
    on_end: Callable[[], object] = lambda: None,
) -> tuple[Trials, FloatArray]:
    """Let gaits walk as the search lets them, side by side in one sim.

    Nothing of it is random but the ground and, where these spread, the start poses: the
    same gait has the same bits again.

    Args:
      config: of the search.
      tried: n gaits, or their vectors (n, 16).
      grounds: n.
      poses: n seeds for the start poses, where the rules let these spread.
      rules: of the walks.
      recorder: notes every tick.
      on_end: called once for each walk that is over.

    Returns:
      How the walks went, and their rewards (n,) [cm/s].
    """
    description = robots.get(config.robot)
    nobody = [np.random.SeedSequence(0)] * len(tried)
    options = config.study("sim").options
    world = make_sim(description, grounds, nobody, options, config.sim)
    with contextlib.closing(world):
        trials = walk_trials(
            world, tried, rules, poses, recorder=recorder, on_end=on_end
        )
    penalty_cm_s = FALL_PENALTY_CM_S * description.scale.speed
    return trials, reward_cm_s(trials, rules.limit_s, penalty_cm_s)


def _seeds(config: OptimizeGait) -> tuple[np.random.SeedSequence, ...]:
    """Of the search: samples, grounds, ratings of its means; of the trials after it."""
    of_search, of_trials = np.random.SeedSequence(config.seed).spawn(2)
    return (*of_search.spawn(3), of_trials)


def _generation(
    config: OptimizeGait, strategy: GaitSearch, ground: Heightfield
) -> dict[str, Any]:
    """One generation, and the mean gait before it beside the samples."""
    tried = np.vstack([strategy.ask(), strategy.mean.to_vector()])
    trials, rewards = rate(config, tried, [ground] * len(tried))
    strategy.tell(rewards[:-1])
    return {
        "rewards": rewards[:-1].tolist(),
        "falls": int(trials.fell[:-1].sum()),
        "mean_reward": float(rewards[-1]),
        "mean_fell": bool(trials.fell[-1]),
        "best_gait": dict(Gait.from_vector(tried[int(rewards[:-1].argmax())])),
        "spread": strategy.spread.tolist(),
        "sigma": strategy.sigma,
    }


def _ratings(config: OptimizeGait, means: FloatArray) -> list[FloatArray]:
    """Rewards (n,) of n mean gaits, again and again: each time on another ground."""
    *_, of_ratings, _ = _seeds(config)
    grounds = search_grounds(config, config.generations + RATINGS)[config.generations :]
    ratings = []
    for ground, pose in zip(grounds, of_ratings.spawn(RATINGS), strict=True):
        alike = [ground.make()] * len(means), [pose] * len(means)
        ratings.append(rate(config, means, *alike, rules=RATED)[1])
    return ratings


def _evaluate(config: OptimizeGait, folder: RunFolder, tuned: Gait) -> dict[str, Any]:
    """Scores of the start and the tuned gait in both worlds, on a course of 3 m."""
    description = robots.get(config.robot)
    both = {"start": load_gait(config.start), "tuned": tuned}
    *_, of_trials = _seeds(config)
    table = {}
    for world, own in zip(WORLDS, of_trials.spawn(2), strict=True):
        outcomes = evaluate(config.study(world), description, both, own)
        table[world] = keep(folder, world, outcomes)
    return table


if __name__ == "__main__":
    run_verb(OptimizeGait, main)
