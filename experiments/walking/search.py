"""CMA-ES over the 16 gait parameters, each scaled to [0, 1]."""

import pickle
from typing import Any, Self

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from walk_engine.gait import PARAMETERS, Gait, from_unit, to_unit

SMALLEST_POPULATION = 4


def check_search(population: int, sigma: float) -> None:
    """Refuse a search that cannot move.

    Raises:
      BadValueError: the population is too small, or the spread is none or too large.
    """
    if population < SMALLEST_POPULATION:
        raise BadValueError(
            f"population is {population}; it must be at least {SMALLEST_POPULATION}"
        )
    if not 0 < sigma <= 1:
        raise BadValueError(f"sigma is {sigma}; it must be above 0 and at most 1")


class _NormalSource:
    """Standard normal numbers of one generator: pycma would use NumPy's global one."""

    def __init__(self, seed: np.random.SeedSequence) -> None:
        self._generator = np.random.default_rng(seed)

    def __call__(self, *shape: int) -> FloatArray:
        return self._generator.standard_normal(shape)


class GaitSearch:
    """Asks for gaits, is told their rewards, and moves its distribution.

    Its answers are the distribution's means, not the luckiest samples. The search can
    be turned into bytes and back without any change to what follows.
    """

    def __init__(
        self,
        start: Gait,
        population: int,
        sigma: float,
        seed: np.random.SeedSequence,
    ) -> None:
        """Begin at a gait.

        Args:
          start: the mean of the first generation.
          population: gaits in a generation.
          sigma: standard deviation of the first generation, as a part of each
            parameter's range.
          seed: of the search's own random numbers.
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
        """(population, 16) vectors of the gaits to try now."""
        self._asked = self._strategy.ask()
        return from_unit(np.array(self._asked))

    def tell(self, rewards: FloatArray) -> None:
        """Learn from the (population,) rewards of the gaits that were asked for."""
        self._strategy.tell(self._asked, (-rewards).tolist())

    @property
    def mean(self) -> Gait:
        """The distribution's mean."""
        unit = np.clip(self._strategy.result.xfavorite, 0.0, 1.0)
        return Gait.from_vector(from_unit(unit))

    @property
    def spread(self) -> FloatArray:
        """(16,) standard deviation of each parameter, as a part of its range."""
        return np.array(self._strategy.result.stds)

    @property
    def sigma(self) -> float:
        """The overall step size."""
        return float(self._strategy.sigma)

    def to_bytes(self) -> bytes:
        """Everything that the search is, between two generations."""
        self._asked = []
        return pickle.dumps(self)

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """The search of `to_bytes`. Runs what the bytes say: only for own files."""
        search = pickle.loads(content)
        if not isinstance(search, cls):
            raise BadValueError("these bytes hold no gait search")
        return search
