"""The verbs `transfer inverted-pendulum` and `transfer half-cheetah`."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from experiments.runs.folder import RESULT, RunFolder, open_run
from experiments.runs.options import RunOptions, check_at_least
from experiments.runs.processes import as_done, process_pool
from experiments.runs.progress import progress
from experiments.transfer.claims import print_study, write_picture
from experiments.transfer.gym_studies.environments import (
    HALF_CHEETAH,
    INVERTED_PENDULUM,
    Domain,
)
from experiments.transfer.gym_studies.page import (
    check_claims,
    returns_figure,
    returns_table,
    rows_of,
    write_gym_page,
)
from experiments.transfer.gym_studies.study import METHODS, Cell, GymStudy, do_job

SizeName = Literal["full", "reduced", "smoke"]
"""How large a study is: the full grid, a reduced one, or a smoke test."""

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


@dataclass(frozen=True)
class TransferGym(RunOptions):
    """Options of a Gymnasium study; a subclass sets its domain.

    Attributes:
      size: size of the study, which sets all options that are not given.
      seeds: number of trainings of each method.
      noises: standard deviations of the noise on the real world's actions, as fractions
        of half of the action's range; each makes a real world of its own.
      methods: methods to compare.
      timesteps: number of environment steps in each training.
      episodes: number of real episodes in which each policy is tried.
      threads: number of trainings at a time, each in its own process.
    """

    domain: ClassVar[Domain]

    size: SizeName = "reduced"
    seeds: int | None = None
    noises: tuple[float, ...] | None = None
    methods: tuple[str, ...] = METHODS
    timesteps: int | None = None
    episodes: int | None = None
    threads: int = 2

    def __post_init__(self) -> None:
        """Refuse options with which nothing can run, before anything is written."""
        self.study()
        check_at_least(self, threads=1)
        super().__post_init__()

    def study(self) -> GymStudy:
        """The study that these options describe."""
        given = {
            name: value
            for name in ("seeds", "noises", "timesteps", "episodes")
            if (value := getattr(self, name)) is not None
        }
        size = SIZES[self.domain.name][self.size]
        return replace(size, methods=self.methods, seed=self.seed, **given)


@dataclass(frozen=True)
class TransferInvertedPendulum(TransferGym):
    """Compare groundings and baselines for a noisy pendulum with a heavier pole."""

    domain: ClassVar[Domain] = INVERTED_PENDULUM


@dataclass(frozen=True)
class TransferHalfCheetah(TransferGym):
    """Compare groundings and baselines for noisy cheetahs, some of them heavier."""

    domain: ClassVar[Domain] = HALF_CHEETAH


def main(config: TransferGym) -> None:
    """Compare the methods in every real world, and write results and page."""
    verb = f"transfer-{config.domain.name}"
    figure = f"{verb.replace('-', '_')}.png"
    folder, config = open_run(verb, config)
    study = config.study()
    cells = _compute(study, folder, config.threads)
    rows = rows_of(cells)
    claims = check_claims(rows)
    result: dict[str, Any] = {
        "size": config.size,
        "rows": rows,
        "claims": [vars(claim) for claim in claims],
        "cells": cells,
    }
    folder.write_json(RESULT, result)
    write_picture(folder, figure, returns_figure, rows)
    write_gym_page(folder, figure, config.size, study, rows, claims)
    table = returns_table(rows, "deterministic")
    print_study(config.json, folder, result, *table, claims)


def _compute(study: GymStudy, folder: RunFolder, threads: int) -> list[Cell]:
    """Do the jobs whose files the run's folder lacks; read the results of all."""
    stages = study.stages()
    every = [job for stage in stages for job in stage]
    done = sum(folder.has(job.file) for job in every)
    with (
        progress("trainings and trials", len(every), done=done) as bar,
        process_pool(threads) as pool,
    ):
        for stage in stages:
            calls = {
                job: pool.submit(do_job, study, folder.path, job)
                for job in stage
                if not folder.has(job.file)
            }
            for job, call in as_done(calls):
                if (cell := call.result()) is not None:
                    folder.write_json(job.file, cell)
                bar.advance()
    return [folder.read_json(job.file) for job in stages[-1]]
