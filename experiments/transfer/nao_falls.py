"""`groundwalk transfer nao-falls`: does the grounded sim know which gaits fall?"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import robots
from experiments.command_line import run_verb
from experiments.grounded_walks.courses import Places, RealCourse
from experiments.grounded_walks.models import WalkModels
from experiments.grounded_walks.walks import (
    ROBOT,
    record_real,
    record_walks,
    walk,
    walk_in_sim,
)
from experiments.runs.folder import HISTORY, RESULT, open_run
from experiments.runs.options import RunOptions
from experiments.runs.progress import progress
from experiments.transfer.claims import print_study, write_picture
from experiments.transfer.nao_studies.falls import (
    FIGURE,
    GROUNDINGS,
    HEADINGS,
    MEASURES,
    MEASURES_FIGURE,
    falls_figure,
    measures_figure,
    measures_of,
    prediction_rows,
    table_of,
    write_falls_page,
)
from experiments.walking.trials import Trials
from groundwalk.errors import BadValueError
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import gaits

VERB = "transfer-nao-falls"
STAGES = 2 + len(GROUNDINGS)


@dataclass(frozen=True)
class TransferNaoFalls(RunOptions):
    """Predict speed and falls of gaits that no grounding has seen.

    Attributes:
      gaits: number of gaits that no grounding learns from.
      trials: number of real walks of each of these gaits, on uneven ground.
      rollouts: number of walks of each of these gaits in every grounded sim.
      real_walks: number of real walks of other gaits, which the groundings learn from.
      sim_walks: number of walks of other gaits in the sim, also to learn from.
    """

    gaits: int = 24
    trials: int = 12
    rollouts: int = 12
    real_walks: int = 96
    sim_walks: int = 220

    def __post_init__(self) -> None:
        """Refuse options with which nothing can run, before anything is written."""
        for name in ("gaits", "trials", "rollouts", "real_walks", "sim_walks"):
            if getattr(self, name) < 2:
                raise BadValueError(f"{name} is {getattr(self, name)}; give at least 2")
        super().__post_init__()


def main(config: TransferNaoFalls) -> None:
    """Walk, learn, predict and compare; results of an earlier run are kept."""
    folder, config = open_run(VERB, config)
    state = folder.read_json(HISTORY) if folder.has(HISTORY) else {}
    with progress("predicting falls", STAGES, done=len(state)) as bar:
        for stage, outcome in _stages(config, state):
            state[stage] = outcome
            folder.write_json(HISTORY, state)
            bar.advance(f"{stage} done")
    rows = prediction_rows(state)
    result = {"predictions": rows, MEASURES: state[MEASURES]}
    folder.write_json(RESULT, result)
    write_picture(folder, MEASURES_FIGURE, measures_figure, state[MEASURES])
    write_picture(folder, FIGURE, falls_figure, state)
    write_falls_page(folder, rows, state, config.trials)
    print_study(config.json, folder, result, HEADINGS, table_of(rows))


def _stages(
    config: TransferNaoFalls, done: Mapping[str, Any]
) -> Iterator[tuple[str, Any]]:
    """Compute the stages that are not `done`; yield the name and result of each."""
    description, start = robots.get(ROBOT), gaits.get("start")
    held_out = GaitCloud().draw(start, config.gaits, _seed(config, 0))
    if "real" not in done:
        vectors = np.repeat(held_out, config.trials, axis=0)
        trials, _ = walk(RealCourse(), description, vectors, _seed(config, 1))
        yield "real", _per_gait(trials, config.gaits)
    if MEASURES in done and all(name in done for name in GROUNDINGS):
        return
    learned = GaitCloud().draw(start, config.real_walks, _seed(config, 2))
    explored = GaitCloud().draw(start, config.sim_walks, _seed(config, 3))
    real = record_real(learned, _seed(config, 4), RealCourse())
    records = record_walks(real, explored, _seed(config, 4), Places())
    models = WalkModels(records, _seed(config, 6))
    if MEASURES not in done:
        _, unseen = walk(RealCourse(), description, held_out, _seed(config, 8))
        yield MEASURES, measures_of(models, unseen, _seed(config, 9))
    for name in GROUNDINGS:
        if name not in done:
            grounded = models.grounded(name)
            seed = _seed(config, 7)
            trials = walk_in_sim(grounded, held_out, config.rollouts, seed)
            yield name, _per_gait(trials, config.gaits)


def _seed(config: TransferNaoFalls, use: int) -> np.random.SeedSequence:
    """The seed for the use with this number, the same at each call."""
    return np.random.SeedSequence(config.seed, spawn_key=(use,))


def _per_gait(trials: Trials, count: int) -> dict[str, list[float]]:
    """Fall rate and mean speed [cm/s] of `count` gaits, in the order of the trials."""
    return {
        "fall_rate": trials.fell.reshape(count, -1).mean(axis=1).tolist(),
        "speed_cm_s": trials.speed_cm_s.reshape(count, -1).mean(axis=1).tolist(),
    }


if __name__ == "__main__":
    run_verb(TransferNaoFalls, main)
