"""Tuning a gait: a search, and a last comparison of what it has found."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from experiments.walking.search import GaitSearch
from experiments.walking.search_run import RATINGS, Entry, best_mean, run_search
from groundwalk.arrays import FloatArray
from walk_engine import Gait

Rater = Callable[[FloatArray, np.random.SeedSequence], FloatArray]
"""(n,) rewards [cm/s] of (n, 16) gaits. All get the same random numbers, so that what
differs between them is the gaits' own."""


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

    @property
    def rated(self) -> int:
        """Ratings of a search: of samples and means, then of all means again."""
        means = self.generations + 1
        return self.generations * (self.population + 1) + RATINGS * means


def tune(
    checkpoint: Path,
    start: Gait,
    budget: Budget,
    rater: Rater,
    seed: np.random.SeedSequence,
) -> Gait:
    """The best of all generations' mean gaits, in a search that begins at another gait.

    All are rated `RATINGS` times more, each time with other random numbers.
    """
    of_search, *of_walks, of_ratings = seed.spawn(2 + budget.generations)

    def generation(number: int, search: GaitSearch) -> Entry:
        tried = np.vstack([search.ask(), search.mean.to_vector()])
        rewards = rater(tried, of_walks[number])
        search.tell(rewards[:-1])
        return {"mean_reward": float(rewards[-1])}

    means = run_search(
        checkpoint,
        lambda: GaitSearch(start, budget.population, budget.sigma, of_search),
        generation,
        budget.generations,
    )
    return best_mean(means, [rater(means, one) for one in of_ratings.spawn(RATINGS)])
