"""`groundwalk transfer inverted-pendulum`: a pole ten times heavier, noisy actions."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

from experiments.command_line import run_verb
from experiments.transfer.gym_studies.environments import INVERTED_PENDULUM, Domain
from experiments.transfer.gym_studies.sizes import SMOKE, Size
from experiments.transfer.gym_studies.training import TrpoConfig
from experiments.transfer.gym_studies.verb import TransferGym, run_study

VERB = "transfer-inverted-pendulum"
TITLE = "Inverted pendulum: from the sim to a noisy world with a heavier pole"
FIGURE = "transfer_inverted_pendulum.png"

TRPO = TrpoConfig(5000, 0.98, 0.9, 0.01, 20, 2.35e-4, 10, 0.00428, 125)
"""The pendulum's values in the grounding papers' later code, `rl_gat`."""

SIZES = {
    "full": Size(
        seeds=10,
        noises=(0.0, 0.1, 0.2, 0.3, 0.4, 0.5),
        timesteps=1_000_000,
        episodes=50,
        real_steps=5000,
        sim_steps=20_000,
        envelopes=(0.1, 0.3, 0.5),
        search_episodes=10,
        trpo=TRPO,
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
        trpo=replace(TRPO, batch=1024, max_kl=0.04, value_batch=128),
    ),
    "smoke": SMOKE,
}


@dataclass(frozen=True)
class TransferInvertedPendulum(TransferGym):
    """Train for noisy, heavier pendulums: no grounding, GAT, SGAT, ANE, real."""

    domain: ClassVar[Domain] = INVERTED_PENDULUM
    sizes: ClassVar[Mapping[str, Size]] = SIZES


def main(config: TransferInvertedPendulum) -> None:
    """Compare the methods, and write everything down."""
    run_study(VERB, TITLE, FIGURE, config)


if __name__ == "__main__":
    run_verb(TransferInvertedPendulum, main)
