"""CMA-ES (evolution strategy) over the 16 gait parameters, scaled to [0, 1]."""

import pickle
from typing import Any, Self

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from walk_engine.gait import PARAMETERS, Gait, from_unit, to_unit

SMALLEST_POPULATION = 4
"""Smallest number of gaits in a generation: CMA-ES needs at least two parents, which it
takes from the better half."""


def check_search(population: int, sigma: float) -> None:
    """Refuse a population or a spread that CMA-ES cannot use.

    Args:
      population: number of gaits in a generation.
      sigma: standard deviation of the first generation, as a share of each parameter's
        range.

    Raises:
      BadValueError: the population is smaller than 4, or sigma is not in (0, 1].
    """
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

    A search can be saved as bytes; after reading it continues with the same bits.
    """

    def __init__(
        self,
        start: Gait,
        population: int,
        sigma: float,
        seed: np.random.SeedSequence,
    ) -> None:
        """Begin a search at a gait.

        Args:
          start: the mean of the first generation.
          population: number of gaits in a generation.
          sigma: standard deviation of the first generation, as a share of each
            parameter's range.
          seed: seed of the samples.
        """
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

    def ask(self) -> FloatArray:
        """Draw the vectors (population, 16) of the gaits to try in this generation."""
        self._asked = self._strategy.ask()
        return from_unit(np.array(self._asked))

    def tell(self, rewards: FloatArray) -> None:
        """Update the search with the rewards (population,) of the gaits from `ask`."""
        self._strategy.tell(self._asked, (-rewards).tolist())

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

    def to_bytes(self) -> bytes:
        """The state of the search between two generations, for `from_bytes`."""
        self._asked = []
        return pickle.dumps(self)

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Restore a search from `to_bytes`; unpickles, so only for trusted files."""
        search = pickle.loads(content)
        if not isinstance(search, cls):
            raise BadValueError("these bytes hold no gait search")
        return search
