"""A gait search from its first to its last generation, with checkpoints.

The answer of a search is the mean of one generation's distribution. From one
generation to the next the mean may move over a cliff, because fast gaits have
neighbours that fall at once. The last mean is therefore not simply the answer: after
the search all means are rated again, with new random numbers, and the best is taken.
"""

import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.progress import progress
from experiments.walking.search import GaitSearch
from groundwalk.arrays import FloatArray
from groundwalk.errors import RunFolderError
from groundwalk.files import write_bytes
from walk_engine import Gait

Entry = dict[str, Any]
"""The record of one generation; its `mean_reward` [cm/s] is shown while it runs."""

MEAN = "mean_gait"
"""Key, in an entry, of the mean gait that the generation began with."""

RATINGS = 10
"""How often every generation's mean gait is rated after the search."""

Rater = Callable[[FloatArray, np.random.SeedSequence], FloatArray]
"""Function that rates n gaits, vectors (n, 16), and returns their rewards (n,) [cm/s].

It draws the same random numbers for all n gaits from the seed, so that only the gaits
make a difference between the rewards."""


@dataclass(frozen=True)
class Budget:
    """The size of a search.

    Attributes:
      population: gaits tried in each generation.
      generations: number of generations.
      sigma: standard deviation of the first generation, as a share of each parameter's
        range.
    """

    population: int
    generations: int
    sigma: float

    @property
    def rated(self) -> int:
        """Number of ratings: samples and means in the search, then all means again."""
        means = self.generations + 1
        return self.generations * (self.population + 1) + RATINGS * means


def run_search(
    checkpoint: Path,
    begin: Callable[[], GaitSearch],
    generation: Callable[[int, GaitSearch], Entry],
    generations: int,
    note: Callable[[list[Entry]], object] = lambda entries: None,
) -> FloatArray:
    """Run the generations of a search that the checkpoint does not hold yet.

    Args:
      checkpoint: a file that is written after every generation.
      begin: makes the search if there is no checkpoint.
      generation: asks for gaits, rates them and tells the search, given the number of
        the generation from 0 on.
      generations: number of generations in all.
      note: is given the entries of all generations after each of them; every entry has
        the `mean_gait` that its generation began with.

    Returns:
      (generations + 1, 16) vectors of the mean gaits, from the first to the last.

    Raises:
      RunFolderError: the checkpoint is damaged, or too old.
    """
    search, entries = _read(checkpoint) if checkpoint.exists() else (begin(), [])
    with progress("search", generations, done=len(entries)) as bar:
        for number in range(len(entries), generations):
            mean = dict(search.mean)
            entry = generation(number, search)
            entries.append({"generation": number, MEAN: mean, **entry})
            state = {"search": search.to_bytes(), "history": entries}
            write_bytes(checkpoint, pickle.dumps(state))
            note(entries)
            bar.advance(f"mean gait {entries[-1]['mean_reward']:.1f} cm/s")
    means = [Gait.from_mapping(entry[MEAN]) for entry in entries]
    return np.array([mean.to_vector() for mean in (*means, search.mean)])


def best_mean(means: FloatArray, ratings: Sequence[FloatArray]) -> Gait:
    """The mean gait with the best average reward.

    Args:
      means: (n, 16) vectors, as `run_search` returns them.
      ratings: one array (n,) of rewards [cm/s] for each time that they were rated.
    """
    return Gait.from_vector(means[np.mean(ratings, axis=0).argmax()])


def tune(
    checkpoint: Path,
    start: Gait,
    budget: Budget,
    rater: Rater,
    seed: np.random.SeedSequence,
) -> Gait:
    """Search for the best gait, and choose it among the means of all generations.

    Args:
      checkpoint: a file that is written after every generation.
      start: the mean of the first generation.
      budget: the size of the search.
      rater: rates gaits in the search, and `RATINGS` times after it.
      seed: of the search and of all ratings.
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


def _read(checkpoint: Path) -> tuple[GaitSearch, list[Entry]]:
    try:
        state = pickle.loads(checkpoint.read_bytes())
    except (pickle.UnpicklingError, EOFError, ValueError) as error:
        raise RunFolderError(f"{checkpoint} is damaged: {error}") from None
    search, entries = GaitSearch.from_bytes(state["search"]), state["history"]
    if not all(MEAN in entry for entry in entries):
        raise RunFolderError(
            f"{checkpoint} is of an earlier version, which did not keep the mean "
            "gaits; begin again in another folder"
        )
    return search, entries
