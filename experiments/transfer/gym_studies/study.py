"""The jobs of a Gymnasium study: train policies, and try them in the real world."""

import itertools
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.options import check_at_least
from experiments.transfer.gym_studies.environments import Domain
from experiments.transfer.gym_studies.grounding import GroundingConfig, ground
from experiments.transfer.gym_studies.training import (
    MakeEnvironment,
    TrpoConfig,
    evaluate,
    load,
    save,
    train,
)
from groundwalk.errors import BadValueError, UnknownNameError
from sgat.models.training import one_thread

NONE, GAT, SGAT, SGAT_FULL, ANE, REAL = METHODS = (
    "none", "gat", "sgat", "sgat-full", "ane", "real"
)  # fmt: skip
"""Methods that are compared by default: no grounding, three groundings by their names
in `sgat.transformers`, action noise envelope (ANE), training in the real world."""

KNOWN = (*METHODS, "sgat-low-rank", "sgat-mixture")
"""All methods that can be compared. To try another grounding, add its name here."""

OF_SIM, OF_DATA, OF_TRAINING, OF_TRIALS, OF_SEARCH = range(5)
"""Numbers by which seeds are derived for different uses; all methods share the seeds,
so that differences between results come from the methods."""

Cell = dict[str, Any]
"""The result of one method with one seed in one real world."""


@dataclass(frozen=True)
class GymStudy:
    """Everything that the results of a study depend on.

    Noises and envelopes are standard deviations of the noise on actions, as fractions
    of half of the action's range.

    Attributes:
      domain: the environment.
      settings: how real worlds differ from the sim; see `Domain.real`.
      noises: noise of each real world.
      methods: methods to compare, some of `KNOWN`.
      seeds: number of trainings of each method, at least 2.
      timesteps: environment steps in each training.
      episodes: real episodes in which each policy is tried, at least 2.
      trpo: parameters of the training algorithm.
      grounding: number of transitions that a grounding collects.
      envelopes: noise levels that the action noise envelope (ANE) chooses from.
      search_episodes: real episodes by which ANE judges a level.
      seed: number from which all random numbers follow.
    """

    domain: Domain
    settings: tuple[str, ...]
    noises: tuple[float, ...]
    methods: tuple[str, ...]
    seeds: int
    timesteps: int
    episodes: int
    trpo: TrpoConfig
    grounding: GroundingConfig
    envelopes: tuple[float, ...]
    search_episodes: int
    seed: int

    def __post_init__(self) -> None:
        """Refuse settings with which nothing can run."""
        for name in ("seeds", "episodes"):
            if getattr(self, name) < 2:
                raise BadValueError(
                    f"{name} is {getattr(self, name)}; a standard error takes 2"
                )
        check_at_least(self, timesteps=1, seed=0)
        if not self.noises or not all(0 <= noise < np.inf for noise in self.noises):
            raise BadValueError(f"noises is {self.noises}; give values from 0 up")
        for kind, given, known in (
            ("method", self.methods, KNOWN),
            ("setting", self.settings, self.domain.settings),
        ):
            for name in given:
                if name not in known:
                    raise UnknownNameError(kind, name, known)
            if not given:
                raise BadValueError(f"no {kind} is given; known are {known}")

    def stages(self) -> list[list["Job"]]:
        """All jobs in three stages: policies of the sim, policies of ANE, all results.

        Each stage needs the files of those before it.
        """
        every = range(self.seeds)
        sims = [Job(k, NONE) for k in every]
        levels = self.envelopes if ANE in self.methods else ()
        around = [Job(k, ANE, level) for k in every for level in levels]
        grid = itertools.product(every, self.settings, self.noises, self.methods)
        cells = [Job(k, m, noise, setting) for k, setting, noise, m in grid]
        return [sims, around, cells]

    def seed_of(self, k: int, stream: int) -> np.random.SeedSequence:
        """The seed of training number `k` for one use, such as `OF_DATA`."""
        return np.random.SeedSequence(self.seed, spawn_key=(k, stream))


@dataclass(frozen=True)
class Job:
    """One piece of work, which writes one file.

    Attributes:
      k: number of the training, from 0.
      method: one of `KNOWN`.
      noise: noise on actions of the real world, or of ANE's sim if `setting` is empty.
      setting: kind of real world; empty for a policy that never sees it.
    """

    k: int
    method: str
    noise: float = 0.0
    setting: str = ""

    @property
    def file(self) -> str:
        """The file's path in the run's folder."""
        name = f"{self.method}_{self.noise:g}_s{self.k}"
        if self.setting:
            return f"cells/{self.setting}_{name}.json"
        return f"policies/{name}.zip"


def do_job(study: GymStudy, folder: Path, job: Job) -> Cell | None:
    """Train a policy that other jobs start from, or compute a method's result.

    The run's folder holds the policies of earlier stages. A result is returned for the
    caller to write; a policy is in its file already, so None is returned.
    """
    with one_thread():
        if job.setting:
            return _cell(study, folder, job)
        if job.method == NONE:
            seed, start = study.seed_of(job.k, OF_SIM), None
            make: MakeEnvironment = study.domain.sim
        else:
            seed = study.seed_of(job.k, OF_TRAINING)
            start = folder / Job(job.k, NONE).file
            make = partial(study.domain.noisy_sim, job.noise)
        model = train(make, study.trpo, study.timesteps, number(seed), start)
        save(model, folder / job.file)
    return None


def _cell(study: GymStudy, folder: Path, job: Job) -> Cell:
    """Find a method's policy; try its mean and its random actions in the real world."""
    found, facts = _policy(study, folder, job)
    cell: Cell = {
        "setting": job.setting,
        "noise": job.noise,
        "method": job.method,
        "seed": job.k,
    }
    seed = number(study.seed_of(job.k, OF_TRIALS))
    for way in ("deterministic", "stochastic"):
        trials = evaluate(
            found, _real(study, job), study.episodes, seed, way == "deterministic"
        )
        cell[way] = {
            "mean": float(trials.returns.mean()),
            "std": float(trials.returns.std(ddof=1)),
        }
    return cell | facts


def _policy(study: GymStudy, folder: Path, job: Job) -> tuple[Any, dict[str, float]]:
    """The policy that a job's method finds, and numbers on its data and models."""
    start = folder / Job(job.k, NONE).file
    if job.method == NONE:
        return load(start), {"real_steps": 0}
    if job.method == ANE:
        return _best_envelope(study, folder, job)
    seed = number(study.seed_of(job.k, OF_TRAINING))
    if job.method == REAL:
        model = train(_real(study, job), study.trpo, study.timesteps, seed, start)
        return model, {"real_steps": model.num_timesteps}
    model = load(start)
    model.set_random_seed(seed)
    grounding = ground(
        model,
        study.domain,
        (job.setting, job.noise),
        study.grounding,
        job.method,
        study.seed_of(job.k, OF_DATA),
    )
    model = train(
        lambda: study.domain.sim(grounding.transformer()),
        study.trpo,
        study.timesteps,
        seed,
        start,
    )
    return model, {"real_steps": study.grounding.real_steps, **grounding.measures}


def _best_envelope(
    study: GymStudy, folder: Path, job: Job
) -> tuple[Any, dict[str, float]]:
    """The policy of ANE: of those for all noise levels, the best in the real world."""
    seed = number(study.seed_of(job.k, OF_SEARCH))
    found, steps = [], 0
    for level in study.envelopes:
        model = load(folder / Job(job.k, ANE, level).file)
        make = _real(study, job)
        trials = evaluate(model, make, study.search_episodes, seed, True)
        found.append((float(trials.returns.mean()), level, model))
        steps += trials.steps
    _, level, model = max(found, key=lambda entry: entry[0])
    return model, {"real_steps": steps, "envelope": level}


def _real(study: GymStudy, job: Job) -> MakeEnvironment:
    return partial(study.domain.real, job.setting, job.noise)


def number(seed: np.random.SeedSequence) -> int:
    """A seed as one number from 0 to 2^31 - 1, as Gymnasium and torch take it."""
    return int(seed.generate_state(1)[0] >> 1)
