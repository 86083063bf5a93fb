"""The jobs of a Gymnasium study: train policies, and try them in the real world."""

import itertools
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from experiments.runs.options import check_at_least
from experiments.transfer.gym_studies.environments import NOISY_SIM, Domain
from experiments.transfer.gym_studies.grounding import ground
from experiments.transfer.gym_studies.training import (
    MakeEnvironment,
    TrpoSettings,
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
      domain: the environment; its settings say how real worlds differ from the sim.
      noises: noise of each real world.
      seeds: number of trainings of each method, at least 2.
      timesteps: environment steps in each training.
      episodes: real episodes in which each policy is tried, at least 2.
      trpo: parameters of the training algorithm.
      real_steps: transitions of the real world that a grounding collects.
      sim_steps: transitions of the sim that a grounding collects.
      envelopes: noise levels that the action noise envelope (ANE) chooses from.
      search_episodes: real episodes by which ANE judges a level.
      methods: methods to compare, some of `KNOWN`.
      seed: number from which all random numbers follow.
    """

    domain: Domain
    noises: tuple[float, ...]
    seeds: int
    timesteps: int
    episodes: int
    trpo: TrpoSettings
    real_steps: int
    sim_steps: int
    envelopes: tuple[float, ...]
    search_episodes: int
    methods: tuple[str, ...] = METHODS
    seed: int = 1

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
        for method in self.methods:
            if method not in KNOWN:
                raise UnknownNameError("method", method, KNOWN)
        if not self.methods:
            raise BadValueError(f"no method is given; known are {KNOWN}")

    def stages(self) -> list[list["Job"]]:
        """All jobs in three stages: policies of the sim, policies of ANE, all results.

        Each stage needs the files of those before it.
        """
        every = range(self.seeds)
        sims = [Job(k, NONE) for k in every]
        levels = self.envelopes if ANE in self.methods else ()
        around = [Job(k, ANE, level) for k in every for level in levels]
        grid = itertools.product(every, self.domain.settings, self.noises, self.methods)
        cells = [Job(k, m, noise, setting) for k, setting, noise, m in grid]
        return [sims, around, cells]

    def seed_of(self, k: int, stream: int) -> np.random.SeedSequence:
        """The seed of training number `k` for one use, such as `OF_DATA`."""
        return np.random.SeedSequence(self.seed, spawn_key=(k, stream))


@dataclass(frozen=True)
class Job:
    """One piece of work, which writes one file: training `k` of a method.

    `setting` is the kind of real world, and `noise` its noise on actions. For a policy
    that never sees the real world `setting` is empty, and the noise is that of the sim.
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
            make = partial(study.domain.real, NOISY_SIM, job.noise)
        model = train(make, study.trpo, study.timesteps, number(seed), start)
        save(model, folder / job.file)
    return None


def _cell(study: GymStudy, folder: Path, job: Job) -> Cell:
    """Find a method's policy; try its mean and its random actions in the real world."""
    found, facts = _policy(study, folder, job)
    cell: Cell = {"setting": job.setting, "noise": job.noise}
    cell |= {"method": job.method, "seed": job.k}
    seed = number(study.seed_of(job.k, OF_TRIALS))
    for way in ("deterministic", "stochastic"):
        returns, _ = evaluate(
            found, _real(study, job), study.episodes, seed, way == "deterministic"
        )
        cell[way] = {"mean": float(returns.mean()), "std": float(returns.std(ddof=1))}
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
    transformer, measures = ground(
        model,
        study.domain,
        (job.setting, job.noise),
        (study.real_steps, study.sim_steps),
        job.method,
        study.seed_of(job.k, OF_DATA),
    )
    model = train(
        lambda: study.domain.sim(transformer()),
        study.trpo,
        study.timesteps,
        seed,
        start,
    )
    return model, {"real_steps": study.real_steps, **measures}


def _best_envelope(
    study: GymStudy, folder: Path, job: Job
) -> tuple[Any, dict[str, float]]:
    """The policy by action noise envelope: of all noise levels the best on real."""
    seed = number(study.seed_of(job.k, OF_SEARCH))
    found, steps = [], 0
    for level in study.envelopes:
        model = load(folder / Job(job.k, ANE, level).file)
        real = _real(study, job)
        returns, taken = evaluate(model, real, study.search_episodes, seed, True)
        found.append((float(returns.mean()), level, model))
        steps += taken
    _, level, model = max(found, key=lambda entry: entry[0])
    return model, {"real_steps": steps, "envelope": level}


def _real(study: GymStudy, job: Job) -> MakeEnvironment:
    return partial(study.domain.real, job.setting, job.noise)


def number(seed: np.random.SeedSequence) -> int:
    """A seed as one number from 0 to 2^31 - 1, as Gymnasium and torch take it."""
    return int(seed.generate_state(1)[0] >> 1)
