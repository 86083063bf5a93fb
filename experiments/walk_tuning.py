"""A search for a gait, and the grounding steps that it may walk in."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

import robots
from experiments.search import GaitSearch
from experiments.search_run import Entry, run_search
from experiments.walk_data import ON_COURSE, GaitCloud, on_lumps, walk
from experiments.walk_groundings import (
    GROUNDINGS,
    ROBOT,
    Walked,
    WalkModels,
)
from experiments.walk_raters import GroundedRater, Rater
from sgat.transitions import Transitions
from walk_engine import Gait

EXPLORATION_RAD = (0.0, 0.01, 0.02, 0.04)
"""Noise on the commands of the sim's walks: it shows what an action does."""

RATED_START_M = 0.1
"""A search's walks are short: they shall not spend half of their time on the flat."""


@dataclass(frozen=True)
class Budget:
    """How much is searched.

    Attributes:
      population: gaits in a generation.
      generations: of a search.
      sigma: spread of the first generation, as a part of each parameter's range.
    """

    population: int
    generations: int
    sigma: float


def tune(
    checkpoint: Path,
    start: Gait,
    budget: Budget,
    rater: Rater,
    seed: np.random.SeedSequence,
) -> Gait:
    """The mean gait of a search that begins at another gait."""
    of_search, *of_walks = seed.spawn(1 + budget.generations)

    def generation(number: int, search: GaitSearch) -> Entry:
        tried = np.vstack([search.ask(), search.mean.to_vector()])
        rewards = rater(tried, of_walks[number])
        search.tell(rewards[:-1])
        return {"mean_reward": float(rewards[-1])}

    return run_search(
        checkpoint,
        lambda: GaitSearch(start, budget.population, budget.sigma, of_search),
        generation,
        budget.generations,
    ).mean


class Grounding:
    """The data of one grounding step and the models learned from them, when asked."""

    def __init__(
        self,
        around: Gait,
        cloud: GaitCloud,
        walks: tuple[int, int],
        seed: np.random.SeedSequence,
        before: "Grounding | None" = None,
    ) -> None:
        """Say what shall be walked.

        Args:
          around: the gait that the data are about.
          cloud: of the gaits that walk.
          walks: in the real world and in the sim.
          seed: of gaits, walks and trainings.
          before: the step before, whose data count as well.
        """
        self._around, self._cloud, self._walks = around, cloud, walks
        self._seeds = [
            np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, use))
            for use in range(5)
        ]
        self._before = before

    @cached_property
    def data(self) -> tuple[Transitions, Transitions, Walked]:
        """Transitions of the real world and of the sim so far, and who fell."""
        description = robots.get(ROBOT)
        of_real, of_sim = (
            self._cloud.draw(self._around, count, seed)
            for count, seed in zip(self._walks, self._seeds, strict=False)
        )
        trials, real = walk(
            "real", description, of_real, self._seeds[2], rules=ON_COURSE
        )
        real, walked = on_lumps(real), Walked(of_real, trials.fell, ON_COURSE)
        _, sim = walk("sim", description, of_sim, self._seeds[3], EXPLORATION_RAD)
        if self._before is None:
            return real, sim, walked
        real_before, sim_before, _ = self._before.data
        return real_before.joined(real), sim_before.joined(sim), walked

    @cached_property
    def models(self) -> WalkModels:
        """Fitted to all data so far."""
        real, sim, walked = self.data
        return WalkModels(real, sim, self._seeds[4], walked)

    def rater(self, grounding: str, repeats: int) -> GroundedRater:
        """The sim behind one of `GROUNDINGS`."""
        assert grounding in GROUNDINGS
        sim = self.models.grounded(grounding)
        return GroundedRater(replace(sim, start_m=RATED_START_M), repeats)


def cloud_around(gait: Gait) -> GaitCloud:
    """Gaits near a tuned one, from half to a little above its speed."""
    fastest_m_s = gait["max_forward"]
    return GaitCloud(0.06, 0.5 * fastest_m_s, min(1.1 * fastest_m_s, 0.45))
