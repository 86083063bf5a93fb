"""How large a Gymnasium study is: the full grid, a reduced one, or a smoke test."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from experiments.transfer.gym_studies.environments import (
    HALF_CHEETAH,
    INVERTED_PENDULUM,
)
from experiments.transfer.gym_studies.training import TrpoConfig

SizeName = Literal["full", "reduced", "smoke"]


@dataclass(frozen=True)
class Size:
    """Values for the options of a study that are not given.

    Noises and envelopes are standard deviations of the noise on actions, as fractions
    of half of the action's range.

    Attributes:
      seeds: number of trainings of each method.
      noises: noise of each real world.
      timesteps: environment steps in each training.
      episodes: real episodes in which each policy is tried.
      real_steps: transitions of the real world that a grounding collects.
      sim_steps: transitions of the sim that a grounding collects.
      envelopes: noise levels that the action noise envelope (ANE) chooses from.
      search_episodes: real episodes by which ANE judges a level.
      trpo: parameters of the training algorithm.
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


PENDULUM_TRPO = TrpoConfig(5000, 0.98, 0.9, 0.01, 20, 2.35e-4, 10, 0.00428, 125)
CHEETAH_TRPO = TrpoConfig(2048, 0.99, 0.95, 0.01, 15, 0.1, 5, 1e-3, 128)
"""Parameters from `rl_gat`, later code by the authors of the GAT and SGAT papers."""

SMOKE_TRPO = TrpoConfig(64, 0.99, 0.95, 0.01, 5, 0.1, 1, 1e-3, 64)
"""Parameters for a smoke test: every step runs, but nothing useful is learned."""

SMOKE = Size(2, (0.5,), 64, 2, 200, 200, (0.2, 0.5), 1, SMOKE_TRPO)

SIZES: Mapping[str, Mapping[SizeName, Size]] = {
    INVERTED_PENDULUM.name: {
        "full": Size(
            seeds=10,
            noises=(0.0, 0.1, 0.2, 0.3, 0.4, 0.5),
            timesteps=1_000_000,
            episodes=50,
            real_steps=5000,
            sim_steps=20_000,
            envelopes=(0.1, 0.3, 0.5),
            search_episodes=10,
            trpo=PENDULUM_TRPO,
        ),
        "reduced": Size(
            seeds=6,
            noises=(0.0, 0.25, 0.5),
            timesteps=100_000,
            episodes=20,
            real_steps=5000,
            sim_steps=10_000,
            envelopes=(0.2, 0.5),
            search_episodes=5,
            trpo=replace(PENDULUM_TRPO, batch=1024, max_kl=0.04, value_batch=128),
        ),
        "smoke": SMOKE,
    },
    HALF_CHEETAH.name: {
        "full": Size(
            seeds=10,
            noises=(0.1, 0.2, 0.3, 0.4, 0.5),
            timesteps=1_000_000,
            episodes=50,
            real_steps=10_000,
            sim_steps=40_000,
            envelopes=(0.1, 0.3, 0.5),
            search_episodes=10,
            trpo=CHEETAH_TRPO,
        ),
        "reduced": Size(
            seeds=3,
            noises=(0.2, 0.5),
            timesteps=200_000,
            episodes=20,
            real_steps=10_000,
            sim_steps=20_000,
            envelopes=(0.1, 0.3, 0.5),
            search_episodes=5,
            trpo=CHEETAH_TRPO,
        ),
        "smoke": SMOKE,
    },
}
"""Sizes of the studies, by the domain's name and the size's."""
