"""The grid of a Gymnasium study: its policies, its cells, and how each is computed."""

import itertools
from collections.abc import Mapping
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
from sgat.models.forward_config import HeadName
from sgat.models.training import one_thread

NONE, GAT, SGAT, SGAT_FULL, ANE, REAL = METHODS = (
    "none", "gat", "sgat", "sgat-full", "ane", "real"
)  # fmt: skip
"""No grounding, the groundings, action noise envelope, training on real."""
GROUNDINGS: Mapping[str, HeadName | None] = {
    GAT: None,
    SGAT: "gaussian",
    SGAT_FULL: "full",
    "sgat-low-rank": "low-rank",
    "sgat-mixture": "mixture",
}
"""From which distribution each grounding samples; GAT takes the mean."""
KNOWN = tuple(dict.fromkeys((*METHODS, *GROUNDINGS)))

OF_SIM, OF_DATA, OF_TRAINING, OF_TRIALS, OF_SEARCH = range(5)
"""Streams of random numbers; methods share them: what differs is what they do."""

Cell = dict[str, Any]
"""What came of one method with one seed in one real world."""


@dataclass(frozen=True)
class GymStudy:
    """Everything that the results depend on.

    Attributes:
      domain: the environment.
      settings: of the real world.
      noises: see `Domain.real`.
      methods: to compare.
      seeds: trainings of each method.
      timesteps: of each training.
      episodes: on real, of each policy that was found; at least 2.
      trpo: of the policies.
      grounding: of the models.
      envelopes: noise levels that ANE chooses from.
      search_episodes: on real, for ANE to judge a level.
      seed: every random number follows from it.
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
        """Refuse what no run can do."""
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
        """What to do; a stage needs the files of those before it."""
        every = range(self.seeds)
        sims = [Job(k, NONE) for k in every]
        levels = self.envelopes if ANE in self.methods else ()
        around = [Job(k, ANE, level) for k in every for level in levels]
        grid = itertools.product(every, self.settings, self.noises, self.methods)
        cells = [Job(k, m, noise, setting) for k, setting, noise, m in grid]
        return [sims, around, cells]

    def seed_of(self, k: int, stream: int) -> np.random.SeedSequence:
        """The random numbers of the training number k for some purpose."""
        return np.random.SeedSequence(self.seed, spawn_key=(k, stream))


@dataclass(frozen=True)
class Job:
    """One piece of work, which leaves one file.

    Attributes:
      k: which of the trainings.
      method: what to do.
      noise: of the real world; of the envelope if there is no real world.
      setting: of the real world; none for a policy that never sees it.
    """

    k: int
    method: str
    noise: float = 0.0
    setting: str = ""

    @property
    def file(self) -> str:
        """In the run's folder."""
        name = f"{self.method}_{self.noise:g}_s{self.k}"
        if self.setting:
            return f"cells/{self.setting}_{name}.json"
        return f"policies/{name}.zip"


def do_job(study: GymStudy, folder: Path, job: Job) -> Cell | None:
    """Train a policy for others and write it, or compute a cell.

    Args:
      study: of which it is a part.
      folder: with the policies of earlier stages.
      job: what to do.

    Returns:
      A cell to be written into the job's file, or None if that is written already.
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
    """Find the method's policy, and try it on real both ways."""
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
    """The policy of a cell's method, and what it took."""
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
        GROUNDINGS[job.method],
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
    """ANE's coarse grid search: the level whose policy returns most on real."""
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
    """A seed as the libraries want it."""
    return int(seed.generate_state(1)[0] >> 1)
