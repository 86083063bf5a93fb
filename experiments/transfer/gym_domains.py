"""The verbs `transfer inverted-pendulum` and `transfer half-cheetah`."""

from dataclasses import dataclass, replace
from typing import Any, ClassVar

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
from experiments.transfer.gym_studies.page import returns_figure, write_gym_page
from experiments.transfer.gym_studies.rows import check_claims, returns_table, rows_of
from experiments.transfer.gym_studies.sizes import SIZES, SizeName
from experiments.transfer.gym_studies.study import METHODS, Cell, GymStudy, do_job


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
