"""How large a Gymnasium study is: the full grid, a reduced one, or a smoke test."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from experiments.transfer.gym_studies.environments import (
    HALF_CHEETAH,
    INVERTED_PENDULUM,
)
from experiments.transfer.gym_studies.study import GymStudy
from experiments.transfer.gym_studies.training import TrpoConfig

SizeName = Literal["full", "reduced", "smoke"]

PENDULUM_TRPO = TrpoConfig(5000, 0.98, 0.9, 0.01, 20, 2.35e-4, 10, 0.00428, 125)
CHEETAH_TRPO = TrpoConfig(2048, 0.99, 0.95, 0.01, 15, 0.1, 5, 1e-3, 128)
"""Parameters from `rl_gat`, later code by the authors of the GAT and SGAT papers."""

SMOKE_TRPO = TrpoConfig(64, 0.99, 0.95, 0.01, 5, 0.1, 1, 1e-3, 64)
"""Parameters for a smoke test: every step runs, but nothing useful is learned."""

PENDULUM = GymStudy(
    INVERTED_PENDULUM,
    noises=(0.0, 0.1, 0.2, 0.3, 0.4, 0.5),
    seeds=10,
    timesteps=1_000_000,
    episodes=50,
    trpo=PENDULUM_TRPO,
    real_steps=5000,
    sim_steps=20_000,
    envelopes=(0.1, 0.3, 0.5),
    search_episodes=10,
)
CHEETAH = replace(
    PENDULUM,
    domain=HALF_CHEETAH,
    noises=(0.1, 0.2, 0.3, 0.4, 0.5),
    trpo=CHEETAH_TRPO,
    real_steps=10_000,
    sim_steps=40_000,
)
SMOKE = GymStudy(
    INVERTED_PENDULUM, (0.5,), 2, 64, 2, SMOKE_TRPO, 200, 200, (0.2, 0.5), 1
)

SIZES: Mapping[str, Mapping[SizeName, GymStudy]] = {
    INVERTED_PENDULUM.name: {
        "full": PENDULUM,
        "reduced": replace(
            PENDULUM,
            noises=(0.0, 0.25, 0.5),
            seeds=6,
            timesteps=100_000,
            episodes=20,
            trpo=replace(PENDULUM_TRPO, batch=1024, max_kl=0.04, value_batch=128),
            sim_steps=10_000,
            envelopes=(0.2, 0.5),
            search_episodes=5,
        ),
        "smoke": SMOKE,
    },
    HALF_CHEETAH.name: {
        "full": CHEETAH,
        "reduced": replace(
            CHEETAH,
            noises=(0.2, 0.5),
            seeds=3,
            timesteps=200_000,
            episodes=20,
            sim_steps=20_000,
            search_episodes=5,
        ),
        "smoke": replace(SMOKE, domain=HALF_CHEETAH),
    },
}
"""The studies with their default options, by the domain's name and the size's."""
