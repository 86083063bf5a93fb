"""CMA-ES over the 16 gait parameters, scaled to [0, 1], and searches with it.

The result of a search is the mean gait of one generation's distribution. Because gaits
close to a fast gait may fall at once, the mean of the last generation may be bad. After
the search the means of all generations are therefore rated again, with new random
numbers, and the best one is the result.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.progress import progress
from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError, RunFolderError
from groundwalk.files import write_text
from walk_engine.gait import PARAMETERS, Gait, from_unit, to_unit

SMALLEST_POPULATION = 4
"""Smallest number of gaits in a generation: CMA-ES needs at least two parents, which it
takes from the better half."""


def check_search(population: int, sigma: float) -> None:
    """Refuse (BadValueError) what CMA-ES cannot use; the arguments are a `Budget`'s."""
    if population < SMALLEST_POPULATION:
        raise BadValueError(
            f"population is {population}; it must be at least {SMALLEST_POPULATION}"
        )
    if not 0 < sigma <= 1:
        raise BadValueError(f"sigma is {sigma}; it must be above 0 and at most 1")


class _NormalSource:
    """Standard normal numbers for pycma, whose default is NumPy's global generator."""

    def __init__(self, seed: np.random.SeedSequence) -> None:
        self._generator = np.random.default_rng(seed)

    def __call__(self, *shape: int) -> FloatArray:
        return self._generator.standard_normal(shape)


class GaitSearch:
    """CMA-ES over gaits: `ask` draws samples, `tell` takes their rewards.

    All follows from its arguments and the rewards: a search that is told the same goes
    on with the same bits.

    Attributes:
      told: rewards of all generations so far.
    """

    def __init__(
        self,
        start: Gait,
        population: int,
        sigma: float,
        seed: np.random.SeedSequence,
    ) -> None:
        """Begin at a gait; `population` and `sigma` are those of a `Budget`."""
        import cma

        check_search(population, sigma)
        options = {
            "popsize": population,
            "bounds": [[0.0] * len(PARAMETERS), [1.0] * len(PARAMETERS)],
            "randn": _NormalSource(seed),
            "seed": np.nan,
            "verbose": -9,
            "verb_log": 0,
        }
        self._strategy: Any = cma.CMAEvolutionStrategy(
            to_unit(start.to_vector()).tolist(), sigma, options
        )
        self._asked: list[FloatArray] = []
        self.told: list[list[float]] = []

    def ask(self) -> FloatArray:
        """Draw the vectors (population, 16) of the gaits to try in this generation."""
        self._asked = self._strategy.ask()
        return from_unit(np.array(self._asked))

    def tell(self, rewards: FloatArray) -> None:
        """Update the search with the rewards (population,) of the gaits from `ask`."""
        self._strategy.tell(self._asked, (-rewards).tolist())
        self.told.append(rewards.tolist())

    @property
    def mean(self) -> Gait:
        """The mean of the distribution from which the next generation is drawn."""
        unit = np.clip(self._strategy.result.xfavorite, 0.0, 1.0)
        return Gait.from_vector(from_unit(unit))

    @property
    def spread(self) -> FloatArray:
        """(16,) standard deviation of each parameter, as a share of its range."""
        return np.array(self._strategy.result.stds)

    @property
    def sigma(self) -> float:
        """The overall step size of CMA-ES, as a share of the parameters' ranges."""
        return float(self._strategy.sigma)


Entry = dict[str, Any]
"""The record of one generation as JSON values, with its `mean_reward` [cm/s]."""

MEAN = "mean_gait"
"""Key, in the record of a generation, of the mean gait that it began with."""

RATINGS = 10
"""Default number of ratings of every generation's mean gait after the search."""

Rater = Callable[[FloatArray, np.random.SeedSequence], FloatArray]
"""Function that rates n gaits, vectors (n, 16), and returns their rewards (n,) [cm/s].

Its second argument is a seed, from which it draws the same random numbers for all n
gaits, so that rewards differ only because of the gaits."""


@dataclass(frozen=True)
class Budget:
    """The size of a search.

    `sigma` is the standard deviation of the first generation, as a share of each
    parameter's range; `ratings` is how often every mean gait is rated after the search.
    """

    population: int
    generations: int
    sigma: float
    ratings: int = RATINGS

    @property
    def rated(self) -> int:
        """Total number of ratings: samples and means in the search, means after it."""
        means = self.generations + 1
        return self.generations * (self.population + 1) + self.ratings * means


def run_search(
    checkpoint: Path,
    begin: Callable[[], GaitSearch],
    generation: Callable[[int, GaitSearch], Entry],
    generations: int,
    note: Callable[[list[Entry]], object] = lambda entries: None,
) -> FloatArray:
    """Run those generations of a search that are not in the checkpoint yet.

    Args:
      checkpoint: a file that is written after every generation.
      begin: makes the search, which is told what the checkpoint holds, if there is one.
      generation: function of the generation's number (from 0) and the search, which
        asks the search for gaits, rates them, tells the rewards and returns a record.
      generations: total number of generations.
      note: called after each generation with all records so far, each with the
        `mean_gait` that its generation began with.

    Returns:
      (generations + 1, 16) vectors of the mean gaits, from the first to the last.

    Raises:
      RunFolderError: the checkpoint is damaged, of an old version of groundwalk, or of
        another search.
    """
    search = begin()
    entries = _resumed(checkpoint, search)
    with progress("search", generations, done=len(entries)) as bar:
        for number in range(len(entries), generations):
            mean = dict(search.mean)
            entry = generation(number, search)
            entries.append({"generation": number, MEAN: mean, **entry})
            state = {"rewards": search.told, "history": entries}
            write_text(checkpoint, json.dumps(state))
            note(entries)
            bar.advance(f"mean gait {entries[-1]['mean_reward']:.1f} cm/s")
    means = [Gait.from_mapping(entry[MEAN]) for entry in entries]
    return np.array([mean.to_vector() for mean in (*means, search.mean)])


def best_mean(means: FloatArray, ratings: FloatArray) -> Gait:
    """The mean gait, of vectors (n, 16), with the best mean of rewards (ratings, n)."""
    return Gait.from_vector(means[np.mean(ratings, axis=0).argmax()])


def tune(
    checkpoint: Path,
    start: Gait,
    budget: Budget,
    rater: Rater,
    seed: np.random.SeedSequence,
) -> Gait:
    """Search from a gait on, and choose the best of the means of all generations.

    The means are rated again after the search. The checkpoint is a file that
    is written after every generation; all randomness follows from the seed.
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
    ratings = [rater(means, one) for one in of_ratings.spawn(budget.ratings)]
    return best_mean(means, np.stack(ratings))


def _resumed(checkpoint: Path, search: GaitSearch) -> list[Entry]:
    """The records in a checkpoint; tells the search the rewards that it holds."""
    if not checkpoint.exists():
        if checkpoint.with_suffix(".pkl").exists():
            raise RunFolderError(
                f"{checkpoint.with_suffix('.pkl')} is of an earlier version, whose "
                "searches cannot go on; begin again in another folder"
            )
        return []
    try:
        state = json.loads(checkpoint.read_bytes())
        history, rewards = list(state["history"]), list(state["rewards"])
        told = [np.array(one, float) for one in rewards]
        means = [Gait.from_mapping(entry[MEAN]).to_vector() for entry in history]
        generations = list(zip(means, told, strict=True))
    except (ValueError, KeyError, TypeError, BadValueError) as error:
        raise RunFolderError(f"{checkpoint} is damaged: {error}") from None
    for mean, one in generations:
        if not np.allclose(search.mean.to_vector(), mean, rtol=1e-9):
            raise RunFolderError(
                f"{checkpoint} is of another search: its mean gaits are not those that "
                "follow from this run's settings; begin again in another folder"
            )
        if len(search.ask()) != len(one):
            raise RunFolderError(f"{checkpoint} is of another size of population")
        search.tell(one)
    return history
