"""Evaluates how well gaits walk a course in a world: mean speed, spread, falls."""

import contextlib
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import worlds
from experiments.runs.folder import RECORDINGS, RunFolder
from experiments.runs.options import check_at_least
from experiments.runs.progress import progress
from experiments.walking.recorder import Recorder, servo_gains
from experiments.walking.sims import make_sim
from experiments.walking.trials import COURSE_TRIAL, TrialRules, Trials, walk_trials
from groundwalk.errors import BadValueError
from robots import Description
from terrain import Heightfield, TerrainSpec, parse
from walk_engine import Gait
from worlds import (
    End,
    Recording,
    RecordingMetadata,
    World,
    WorldOptions,
    write_recording,
)
from worlds.hidden.effects import Hidden

MOST_AT_ONCE = 60
"""Largest number of robots that walk at the same time, because each needs 70 MB of
memory in the real world (PyBullet)."""


@dataclass(frozen=True)
class Score:
    """Summary of the trials of one gait in one world.

    Attributes:
      speed_cm_s: forward speed [cm/s], the mean over the trials; the speed of a trial
        with a fall is that until the fall.
      speed_std: standard deviation of the speed over the trials [cm/s].
      falls: number of trials that ended with a fall.
      trials: number of trials.
    """

    speed_cm_s: float
    speed_std: float
    falls: int
    trials: int


@dataclass(frozen=True)
class Study:
    """The world, the ground and the rules of an evaluation of gaits.

    Attributes:
      world: "sim" or "real".
      terrain: the ground, as text such as "lumps:amplitude_m=0.01"; each trial has
        another random seed.
      trials: number of trials of each gait.
      rules: how a trial begins, and when it is over.
      threads: threads of the sim, or processes of the real world; 0 for one per core.
      correction: run folder or `corrected.json` of a diagnosis, whose effects are added
        to the sim; None for the plain sim.
      hidden: effects that the real world has and the sim does not.
    """

    world: str
    terrain: str
    trials: int = 10
    rules: TrialRules = COURSE_TRIAL
    threads: int = 0
    correction: Path | None = None
    hidden: tuple[Hidden, ...] = ()

    def __post_init__(self) -> None:
        """Refuse an unknown world or terrain, or fewer than one trial."""
        worlds.kind(self.world)
        parse(self.terrain)
        check_at_least(self, trials=1, threads=0)
        if self.correction is not None and self.world != "sim":
            raise BadValueError(f"only the sim can be corrected, not {self.world!r}")
        if self.hidden and self.world != "real":
            raise BadValueError(f"only real hides physics, not {self.world!r}")

    def make_world(
        self,
        description: Description,
        grounds: Sequence[Heightfield],
        seeds: Sequence[np.random.SeedSequence],
    ) -> World:
        """Make the world, with one robot and one seed for each ground."""
        robots = description, grounds, seeds, self.options
        if self.correction is None:
            return worlds.make(self.world, *robots)
        return make_sim(*robots, self.correction)

    @property
    def options(self) -> WorldOptions:
        """The world's default options with this study's threads and hidden effects."""
        return dataclasses.replace(
            worlds.kind(self.world).options, hidden=self.hidden, threads=self.threads
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """The trials of one gait in a world.

    Attributes:
      score: summary of the trials.
      trials: distance, duration and end of each trial.
      recording: recording of the first trial.
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
      study: world, ground and rules of the trials.
      description: the robot model.
      gaits: the gaits by name.
      seed: seed of the grounds, the sensor noise and the start poses.

    Returns:
      The outcome of each gait, by its name.
    """
    starts = _starts(study, seed)
    rows = [(name, start) for name in gaits for start in starts]
    walked: list[Trials] = []
    recordings: dict[str, Recording] = {}
    with progress(f"trials in {study.world}", len(rows)) as bar:
        for first in range(0, len(rows), MOST_AT_ONCE):
            wave = rows[first : first + MOST_AT_ONCE]
            trials, recorded = _walk(study, description, gaits, wave, bar.advance)
            walked.append(trials)
            recordings |= recorded
    outcomes = {}
    for i, name in enumerate(gaits):
        own = Trials.joined(walked).part(i * study.trials, (i + 1) * study.trials)
        outcomes[name] = Outcome(score(own), own, recordings[name])
    return outcomes


@dataclass(frozen=True, eq=False)
class _Start:
    """Number, ground and seeds of a trial, which are the same for all gaits."""

    number: int
    spec: TerrainSpec
    ground: Heightfield
    of_noise: np.random.SeedSequence
    of_pose: np.random.SeedSequence


def _starts(study: Study, seed: np.random.SeedSequence) -> list[_Start]:
    starts = []
    children = zip(*(child.spawn(study.trials) for child in seed.spawn(3)), strict=True)
    for number, (of_ground, of_noise, of_pose) in enumerate(children):
        ground_seed = int(of_ground.generate_state(1)[0])
        spec = TerrainSpec(*parse(study.terrain), seed=ground_seed)
        starts.append(_Start(number, spec, spec.make(), of_noise, of_pose))
    return starts


def _walk(
    study: Study,
    description: Description,
    gaits: Mapping[str, Gait],
    wave: Sequence[tuple[str, _Start]],
    on_end: Callable[[], object],
) -> tuple[Trials, dict[str, Recording]]:
    """Run trials (gait name and start) in one world; record each gait's trial 0."""
    starts = [start for _, start in wave]
    grounds, seeds = [s.ground for s in starts], [s.of_noise for s in starts]
    world = study.make_world(description, grounds, seeds)
    firsts = [i for i, start in enumerate(starts) if start.number == 0]
    recorder = Recorder(description, firsts)
    with contextlib.closing(world):
        trials = walk_trials(
            world,
            [gaits[name] for name, _ in wave],
            study.rules,
            [s.of_pose for s in starts],
            recorder,
            on_end,
        )
    recordings = {}
    for i in firsts:
        name, start = wave[i]
        end = trials.ended[i]
        metadata = _metadata(study, description, start.spec, gaits[name], end)
        recordings[name] = recorder.recording(i, metadata)
    return trials, recordings


def score(trials: Trials) -> Score:
    """Summarize trials; of a single trial the standard deviation is set to zero."""
    speed = trials.speed_cm_s
    return Score(
        speed_cm_s=float(speed.mean()),
        speed_std=float(speed.std(ddof=1)) if len(speed) > 1 else 0.0,
        falls=int(trials.fell.sum()),
        trials=len(speed),
    )


def _metadata(
    study: Study,
    description: Description,
    ground: TerrainSpec,
    gait: Gait,
    end: End,
) -> RecordingMetadata:
    latency_ms = study.options.latency_s * 1e3
    corrected = "" if study.correction is None else "corrected "
    return RecordingMetadata(
        robot=description.name,
        base="floating",
        source=f"groundwalk, {corrected}{study.world} world, "
        f"command latency {latency_ms:.0f} ms",
        servo=servo_gains(description),
        terrain=ground.to_json(),
        gait=dict(gait),
        world=study.world,
        end=str(end),
    )


def keep(
    folder: RunFolder, world: str, outcomes: Mapping[str, Outcome]
) -> dict[str, dict[str, Any]]:
    """Write the recordings of all gaits in a world into a run folder.

    Returns:
      The fields of each gait's `Score`, by the name of the gait.
    """
    for name, outcome in outcomes.items():
        path = folder.path / RECORDINGS / f"{world}_{name}.parquet"
        write_recording(outcome.recording, path)
    return {name: dataclasses.asdict(out.score) for name, out in outcomes.items()}
