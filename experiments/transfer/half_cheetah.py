"""`groundwalk transfer half-cheetah`: noisy actions, with or without more mass."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from experiments.command_line import run_verb
from experiments.transfer.gym_studies.environments import HALF_CHEETAH, Domain
from experiments.transfer.gym_studies.sizes import SMOKE, Size
from experiments.transfer.gym_studies.training import TrpoConfig
from experiments.transfer.gym_studies.verb import TransferGym, run_study

VERB = "transfer-half-cheetah"
TITLE = "Half cheetah: from the sim to noisy worlds, one of them heavier"
FIGURE = "transfer_half_cheetah.png"

TRPO = TrpoConfig(2048, 0.99, 0.95, 0.01, 15, 0.1, 5, 1e-3, 128)
"""The cheetah's values in the grounding papers' later code, `rl_gat`."""

SIZES = {
    "full": Size(
        seeds=10,
        noises=(0.1, 0.2, 0.3, 0.4, 0.5),
        timesteps=1_000_000,
        episodes=50,
        real_steps=10_000,
        sim_steps=40_000,
        envelopes=(0.1, 0.3, 0.5),
        search_episodes=10,
        trpo=TRPO,
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
        trpo=TRPO,
    ),
    "smoke": SMOKE,
}


@dataclass(frozen=True)
class TransferHalfCheetah(TransferGym):
    """Train cheetahs for noisy, heavier worlds: no grounding, GAT, SGAT, ANE, real."""

    domain: ClassVar[Domain] = HALF_CHEETAH
    sizes: ClassVar[Mapping[str, Size]] = SIZES


def main(config: TransferHalfCheetah) -> None:
    """Compare the methods, and write everything down."""
    run_study(VERB, TITLE, FIGURE, config)


if __name__ == "__main__":
    run_verb(TransferHalfCheetah, main)
