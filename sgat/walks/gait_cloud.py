"""Random gaits around a given one, whose walks a grounding learns from."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from groundwalk.arrays import FloatArray
from walk_engine import Gait
from walk_engine.gait import NAMES, from_unit, to_unit


@dataclass(frozen=True)
class GaitCloud:
    """Random gaits around one gait, with uniformly drawn speeds.

    Attributes:
      spread: standard deviation of each parameter, as a fraction of its range.
      slowest_m_s: least forward speed that a gait asks for [m/s].
      fastest_m_s: largest forward speed that a gait asks for [m/s].

    Example:
      >>> GaitCloud().draw(gaits.get("start"), 8, np.random.SeedSequence(1)).shape
      (8, 16)
    """

    spread: float = 0.12
    slowest_m_s: float = 0.12
    fastest_m_s: float = 0.40

    @classmethod
    def near(cls, gait: Gait) -> Self:
        """Gaits close to a tuned one: 0.5 to 1.1 times its speed, at most 0.45 m/s."""
        fastest_m_s = gait["max_forward"]
        return cls(0.06, 0.5 * fastest_m_s, min(1.1 * fastest_m_s, 0.45))

    def draw(
        self, around: Gait, count: int, seed: np.random.SeedSequence
    ) -> FloatArray:
        """(count, 16) random gaits around one, in the order of `PARAMETERS`.

        The same seed gives the same gaits.
        """
        rng = np.random.default_rng(seed)
        unit = to_unit(around.to_vector()) + rng.normal(0, self.spread, (count, 16))
        vectors = from_unit(np.clip(unit, 0.02, 0.98))
        speeds = rng.uniform(self.slowest_m_s, self.fastest_m_s, count)
        vectors[:, NAMES.index("max_forward")] = speeds
        return vectors
