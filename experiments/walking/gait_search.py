"""The search of `groundwalk optimize-gait`: tunes a gait for a terrain in the sim."""

import contextlib
import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import robots
import worlds
from experiments.runs.folder import CHECKPOINT, HISTORY, RunFolder
from experiments.runs.gait_files import load_gait
from experiments.runs.options import check_at_least
from experiments.walking.evaluation import check_correction, make_sim
from experiments.walking.recorder import Recorder
from experiments.walking.search import (
    RATINGS,
    GaitSearch,
    best_mean,
    check_search,
    run_search,
)
from experiments.walking.trials import (
    FALL_PENALTY_CM_S,
    SEARCH_TRIAL,
    TrialRules,
    Trials,
    reward_cm_s,
    walk_trials,
)
from groundwalk.arrays import FloatArray
from terrain import Heightfield, TerrainSpec, parse
from walk_engine import Gait
from worlds import WorldOptions

SEARCH_VERB = "optimize-gait"
"""Name of the verb whose run folders hold a search for a gait."""

RATED = dataclasses.replace(SEARCH_TRIAL, start_spread_rad=0.01)
"""Rules for rating the generations' mean gaits after the search. The start poses have a
standard deviation of 0.01 rad, so that no gait wins that needs one exact pose."""


@dataclass(frozen=True)
class SearchPlan:
    """Options of a search for a gait, as of `groundwalk optimize-gait`.

    `start` is the name or file of a gait; `sim` is the run folder of a diagnosis, whose
    effects are added to the sim.
    """

    robot: str = "nao"
    start: str = "start"
    terrain: str = "flat"
    sim: Path | None = None
    population: int = 150
    generations: int = 15
    sigma: float = 0.15
    ratings: int = RATINGS
    seed: int = 1
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse invalid options of a search."""
        description = robots.get(self.robot)
        if self.sim is not None:
            check_correction(description, self.options, self.sim)
        load_gait(self.start)
        parse(self.terrain)
        check_search(self.population, self.sigma)
        check_at_least(self, generations=1, ratings=1, seed=0, threads=0)

    @property
    def options(self) -> WorldOptions:
        """Options of the sim in which the gaits are rated."""
        return dataclasses.replace(worlds.kind("sim").options, threads=self.threads)

    def seeds(self) -> tuple[np.random.SeedSequence, ...]:
        """Seeds of CMA-ES, of the grounds, of the final ratings, of the later trials.

        They do not depend on the number of generations.
        """
        of_search, of_trials = np.random.SeedSequence(self.seed).spawn(2)
        return (*of_search.spawn(3), of_trials)

    def grounds(self, generations: int) -> list[TerrainSpec]:
        """The ground of each of the first `generations` generations."""
        _, of_grounds, *_ = self.seeds()
        seeds = of_grounds.generate_state(generations).tolist()
        return [TerrainSpec(*parse(self.terrain), seed=seed) for seed in seeds]


def search_gait(plan: SearchPlan, folder: RunFolder) -> Gait:
    """The best of all generations' mean gaits, by a rating after the search.

    Generations that the run folder already holds are not repeated.
    """
    of_samples, *_ = plan.seeds()
    start, grounds = load_gait(plan.start), plan.grounds(plan.generations)
    means = run_search(
        folder.path / CHECKPOINT,
        lambda: GaitSearch(start, plan.population, plan.sigma, of_samples),
        lambda number, strategy: _generation(plan, strategy, grounds[number].make()),
        plan.generations,
        lambda entries: folder.write_json(HISTORY, {"generations": entries}),
    )
    return best_mean(means, _ratings(plan, means))


def rate(
    plan: SearchPlan,
    tried: Sequence[Gait] | FloatArray,
    grounds: Sequence[Heightfield],
    poses: Sequence[np.random.SeedSequence] = (),
    rules: TrialRules = SEARCH_TRIAL,
    recorder: Recorder | None = None,
    on_end: Callable[[], object] = lambda: None,
) -> tuple[Trials, FloatArray]:
    """Let n gaits walk in one sim, and compute the rewards (n,) [cm/s] of the search.

    Only the ground and (if the rules spread them) the start poses are random: the same
    gait on the same ground with the same pose gives the same bits again. The other
    arguments are those of `experiments.walking.trials.walk_trials`.
    """
    description = robots.get(plan.robot)
    noiseless = [np.random.SeedSequence(0)] * len(tried)
    world = make_sim(description, grounds, noiseless, plan.options, plan.sim)
    with contextlib.closing(world):
        trials = walk_trials(
            world, tried, rules, poses, recorder=recorder, on_end=on_end
        )
    penalty_cm_s = FALL_PENALTY_CM_S * description.scale.speed
    return trials, reward_cm_s(trials, rules.limit_s, penalty_cm_s)


def _generation(
    plan: SearchPlan, strategy: GaitSearch, ground: Heightfield
) -> dict[str, Any]:
    """Run a generation of CMA-ES: rate its samples and its mean; return its record."""
    tried = np.vstack([strategy.ask(), strategy.mean.to_vector()])
    under = [ground] * len(tried)
    trials, rewards = rate(plan, tried, under, rules=SEARCH_TRIAL)
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


def _ratings(plan: SearchPlan, means: FloatArray) -> FloatArray:
    """(ratings, n) rewards [cm/s] of n gaits, each time on another ground."""
    _, _, of_ratings, _ = plan.seeds()
    grounds = plan.grounds(plan.generations + plan.ratings)[plan.generations :]
    under = [ground for spec in grounds for ground in [spec.make()] * len(means)]
    poses = [pose for pose in of_ratings.spawn(plan.ratings) for _ in means]
    _, rewards = rate(plan, np.tile(means, (plan.ratings, 1)), under, poses, RATED)
    return rewards.reshape(plan.ratings, len(means))
