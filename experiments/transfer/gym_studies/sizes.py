"""How large a Gymnasium study is: the full grid, a reduced one, or a smoke test."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from experiments.transfer.gym_studies.environments import (
    HALF_CHEETAH,
    INVERTED_PENDULUM,
)
from experiments.transfer.gym_studies.study import GymStudy

SizeName = Literal["full", "reduced", "smoke"]

PENDULUM_TRPO = {
    "batch": 5000, "gamma": 0.98, "gae_lambda": 0.9, "max_kl": 0.01, "cg_steps": 20,
    "cg_damping": 2.35e-4, "value_epochs": 10, "value_rate": 0.00428,
    "value_batch": 125,
}  # fmt: skip
CHEETAH_TRPO = {
    "batch": 2048, "gamma": 0.99, "gae_lambda": 0.95, "max_kl": 0.01, "cg_steps": 15,
    "cg_damping": 0.1, "value_epochs": 5, "value_rate": 1e-3, "value_batch": 128,
}  # fmt: skip
"""Parameters from `rl_gat`, later code by the authors of the GAT and SGAT papers."""

SMOKE_TRPO = CHEETAH_TRPO | {
    "batch": 64, "cg_steps": 5, "value_epochs": 1, "value_batch": 64,
}  # fmt: skip
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
            trpo=PENDULUM_TRPO | {"batch": 1024, "max_kl": 0.04, "value_batch": 128},
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
