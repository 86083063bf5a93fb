"""How large a Gymnasium study is: the full grid, a reduced one, or a smoke test."""

from dataclasses import dataclass
from typing import Literal

from experiments.transfer.gym_studies.training import TrpoConfig

SizeName = Literal["full", "reduced", "smoke"]


@dataclass(frozen=True)
class Size:
    """What the options of a study stand for where they are not given.

    Attributes:
      seeds: trainings of each method.
      noises: of the real worlds.
      timesteps: of each training.
      episodes: on real, of each policy that was found.
      real_steps: transitions of the real world for a grounding.
      sim_steps: transitions of the sim for a grounding.
      envelopes: noise levels that ANE chooses from.
      search_episodes: on real, for ANE to judge a level.
      trpo: of the policies.
    """

    seeds: int
    noises: tuple[float, ...]
    timesteps: int
    episodes: int
    real_steps: int
    sim_steps: int
    envelopes: tuple[float, ...]
    search_episodes: int
    trpo: TrpoConfig


SMOKE_TRPO = TrpoConfig(64, 0.99, 0.95, 0.01, 5, 0.1, 1, 1e-3, 64)

SMOKE = Size(2, (0.5,), 64, 2, 200, 200, (0.2, 0.5), 1, SMOKE_TRPO)
