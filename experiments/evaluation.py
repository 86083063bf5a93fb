"""How well gaits walk a course in a world: speed, its spread, and falls."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import worlds
from experiments.progress import progress
from experiments.recorder import Recorder, servo_gains
from experiments.run_folder import RECORDINGS, RunFolder
from experiments.trials import COURSE_TRIAL, TrialRules, Trials, walk_trials
from groundwalk.arrays import BoolArray
from groundwalk.errors import BadValueError
from robots import Description
from terrain import TerrainSpec, parse
from walk_engine import Gait
from worlds import Recording, RecordingMetadata, WorldOptions, write_recording


@dataclass(frozen=True)
class Score:
    """What trials of one gait in one world came to.

    Attributes:
      speed_cm_s: mean forward speed, until the fall where the robot fell.
      speed_std: standard deviation of the speed over the trials.
      falls: how many trials ended with a fall.
      trials: how many there were.
    """

    speed_cm_s: float
    speed_std: float
    falls: int
    trials: int


@dataclass(frozen=True)
class Study:
    """Where and how gaits are evaluated.

    Attributes:
      world: "sim" or "real".
      terrain: such as "lumps:amplitude_m=0.01"; every trial has its own seed.
      trials: of each gait.
      rules: when a trial is over.
      threads: of the sim, or processes of the real world; 0 for one per core.
    """

    world: str
    terrain: str
    trials: int = 10
    rules: TrialRules = COURSE_TRIAL
    threads: int = 0

    def __post_init__(self) -> None:
        """Refuse unknown worlds and terrains, and no trials."""
        worlds.kind(self.world)
        parse(self.terrain)
        if self.trials < 1:
            raise BadValueError(f"trials is {self.trials}; it must be at least 1")

    @property
    def options(self) -> WorldOptions:
        """The world's own options, on these threads."""
        return dataclasses.replace(
            worlds.kind(self.world).options, threads=self.threads
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """One gait's trials in a world.

    Attributes:
      score: the summary.
      trials: each of them.
      recording: the first trial, written down.
    """

    score: Score
    trials: Trials
    recording: Recording


def evaluate(
    study: Study,
    description: Description,
    gaits: Mapping[str, Gait],
    seed: np.random.SeedSequence,
) -> dict[str, Outcome]:
    """Let each gait walk the same trials: the same grounds, noise and start poses.

    Args:
      study: where and how.
      description: the robot.
      gaits: by name.
      seed: of the grounds, the noise and the start poses.
    """
    of_grounds, of_noise, of_start = (
        child.spawn(study.trials) for child in seed.spawn(3)
    )
    specs = [_ground(study, child) for child in of_grounds]
    grounds = [spec.make() for spec in specs]
    copies = len(gaits)
    world = worlds.make(
        study.world, description, grounds * copies, of_noise * copies, study.options
    )
    recorder = Recorder(description, range(0, world.n, study.trials))
    vectors = np.repeat([gait.to_vector() for gait in gaits.values()], study.trials, 0)
    try:
        with progress(f"trials in {study.world}", world.n) as bar:
            still = [np.ones(world.n, bool)]

            def on_tick(active: BoolArray) -> None:
                for _ in range(int((still[0] & ~active).sum())):
                    bar.advance()
                still[0] = active

            trials = walk_trials(
                world, vectors, study.rules, of_start * copies, recorder, on_tick
            )
    finally:
        world.close()
    outcomes = {}
    for i, (name, gait) in enumerate(gaits.items()):
        first = i * study.trials
        own = trials.part(first, first + study.trials)
        metadata = _metadata(study, description, specs[0], gait, own)
        outcomes[name] = Outcome(score(own), own, recorder.recording(first, metadata))
    return outcomes


def score(trials: Trials) -> Score:
    """Trials in four numbers; the spread of one trial is zero."""
    speed = trials.speed_cm_s
    return Score(
        speed_cm_s=float(speed.mean()),
        speed_std=float(speed.std(ddof=1)) if len(speed) > 1 else 0.0,
        falls=int(trials.fell.sum()),
        trials=len(speed),
    )


def _ground(study: Study, seed: np.random.SeedSequence) -> TerrainSpec:
    """One trial's ground."""
    return TerrainSpec(*parse(study.terrain), seed=int(seed.generate_state(1)[0]))


def _metadata(
    study: Study,
    description: Description,
    ground: TerrainSpec,
    gait: Gait,
    trials: Trials,
) -> RecordingMetadata:
    latency_ms = study.options.latency_s * 1e3
    return RecordingMetadata(
        robot=description.name,
        base="floating",
        source=f"groundwalk, {study.world} world, command latency {latency_ms:.0f} ms",
        servo=servo_gains(description),
        terrain=ground.to_json(),
        gait=dict(gait),
        world=study.world,
        end=str(trials.ended[0]),
    )


def keep(
    folder: RunFolder, world: str, outcomes: Mapping[str, Outcome]
) -> dict[str, dict[str, Any]]:
    """Write the recordings into a run folder; the scores as plain values, by gait."""
    for name, outcome in outcomes.items():
        path = folder.path / RECORDINGS / f"{world}_{name}.parquet"
        write_recording(outcome.recording, path)
    return {name: dataclasses.asdict(out.score) for name, out in outcomes.items()}
