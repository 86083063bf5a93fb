"""Evaluates how well gaits walk a course in a world: mean speed, spread, falls.

A sim may be plain, or have the effects that a diagnosis has found.
"""

import contextlib
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import worlds
from diagnosis.corrected.effects_json import load_correction
from diagnosis.corrected.sim import CorrectedSim, sim_plant, sim_variants
from diagnosis.residuals.predictor import Model
from experiments.runs.folder import RECORDINGS, RunFolder
from experiments.runs.options import check_at_least
from experiments.runs.progress import progress
from experiments.walking.recorder import Recorder, servo_gains
from experiments.walking.trials import COURSE_TRIAL, TrialRules, Trials, walk_trials
from groundwalk.errors import BadValueError
from robots import Description
from terrain import Heightfield, TerrainSpec, configuration, parse
from walk_engine import Gait
from worlds import Recording, RecordingMetadata, World, WorldOptions, write_recording
from worlds.hidden.effects import Hidden


def make_sim(
    description: Description,
    grounds: Sequence[Heightfield],
    seeds: Sequence[np.random.SeedSequence],
    options: WorldOptions,
    correction: Path | None = None,
) -> World:
    """Make a sim with one robot on each ground, and a seed of sensor noise for each.

    The effects of the correction, run folder or `corrected.json` of a diagnosis, are
    added to it.

    Raises:
      BadModelError: the correction is no diagnosis of this robot, or the sim cannot
        simulate one of its effects.
      UnknownNameError: the correction names an unknown effect or joint.
    """
    if correction is None:
        return worlds.make("sim", description, grounds, seeds, options)
    model = check_correction(description, options, correction)
    return CorrectedSim(description, grounds, seeds, options, model)


def check_correction(
    description: Description, options: WorldOptions, correction: Path
) -> Model:
    """Check that the sim can simulate the effects of a diagnosis, and return them.

    Raises the errors of `make_sim`.
    """
    plant = sim_plant(description, options)
    model = load_correction(correction, plant)
    sim_variants(plant, model, 1)
    return model


MOST_AT_ONCE = 60
"""Largest number of robots that walk at the same time, because each needs 70 MB of
memory in the real world (PyBullet)."""


@dataclass(frozen=True)
class Score:
    """Trials of one gait in one world: mean speed and its standard deviation, falls.

    The forward speed of a trial with a fall is that until the fall.
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
      correction: diagnosis whose effects are added to the sim; see `make_sim`.
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
        """Refuse an unknown world, ground that the course leaves, or no trials."""
        worlds.kind(self.world)
        name, parameters = parse(self.terrain)
        end_m = configuration(name, **parameters).x_range_m[1]
        if self.rules.course_m is not None and self.rules.course_m >= end_m:
            raise BadValueError(
                f"course_m is {self.rules.course_m:g}, but the ground ends at "
                f"{end_m:g} m; for a longer one put x_range_m=-1:9 behind its name"
            )
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


class Outcome(NamedTuple):
    """Trials of one gait in a world, their summary, and the first one's recording."""

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

    These follow from the seed. Gaits and outcomes are by the gaits' names.
    """
    starts = _starts(study, seed)
    rows = [(name, start) for name in gaits for start in starts]
    corrected = "" if study.correction is None else "corrected "
    source = (
        f"groundwalk, {corrected}{study.world} world, "
        f"command latency {study.options.latency_s * 1e3:.0f} ms"
    )
    walked: list[Trials] = []
    recordings: dict[str, Recording] = {}
    with progress(f"trials in {study.world}", len(rows)) as bar:
        for first in range(0, len(rows), MOST_AT_ONCE):
            wave = rows[first : first + MOST_AT_ONCE]
            world = study.make_world(
                description,
                [start.ground for _, start in wave],
                [start.of_noise for _, start in wave],
            )
            trials, recorded = walk_recorded(
                world,
                [(gaits[name], start) for name, start in wave],
                study.rules,
                [i for i, (_, start) in enumerate(wave) if start is starts[0]],
                (study.world, source),
                bar.advance,
            )
            walked.append(trials)
            recordings |= {wave[i][0]: one for i, one in recorded.items()}
    outcomes = {}
    for i, name in enumerate(gaits):
        own = Trials.joined(walked).part(i * study.trials, (i + 1) * study.trials)
        outcomes[name] = Outcome(score(own), own, recordings[name])
    return outcomes


class Start(NamedTuple):
    """Ground and seeds of a trial, which are the same for all gaits."""

    spec: TerrainSpec
    ground: Heightfield
    of_noise: np.random.SeedSequence
    of_pose: np.random.SeedSequence


def _starts(study: Study, seed: np.random.SeedSequence) -> list[Start]:
    starts = []
    children = zip(*(child.spawn(study.trials) for child in seed.spawn(3)), strict=True)
    for of_ground, of_noise, of_pose in children:
        ground_seed = int(of_ground.generate_state(1)[0])
        spec = TerrainSpec(*parse(study.terrain), seed=ground_seed)
        starts.append(Start(spec, spec.make(), of_noise, of_pose))
    return starts


def walk_recorded(
    world: World,
    rows: Sequence[tuple[Gait, Start]],
    rules: TrialRules,
    recorded: Sequence[int],
    about: tuple[str, str],
    on_end: Callable[[], object],
) -> tuple[Trials, dict[int, Recording]]:
    """Run trials side by side in a world, close it, and record some of the trials.

    The world has the grounds and the noise of the rows' starts. `recorded` are indices
    of rows; `about` is world and source for the metadata of the recordings.
    """
    robot, recorder = world.description, Recorder(world.description, recorded)
    poses = [start.of_pose for _, start in rows]
    with contextlib.closing(world):
        trials = walk_trials(
            world, [gait for gait, _ in rows], rules, poses, recorder, on_end
        )
    recordings = {}
    for i in recorded:
        gait, start = rows[i]
        metadata = RecordingMetadata(
            robot=robot.name,
            base="floating",
            source=about[1],
            servo=servo_gains(robot),
            terrain=start.spec.to_json(),
            gait=dict(gait),
            world=about[0],
            end=str(trials.ended[i]),
        )
        recordings[i] = recorder.recording(i, metadata)
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


def keep(
    folder: RunFolder, world: str, outcomes: Mapping[str, Outcome]
) -> dict[str, dict[str, Any]]:
    """Write all gaits' recordings into a run folder; return their scores by name."""
    for name, outcome in outcomes.items():
        path = folder.path / RECORDINGS / f"{world}_{name}.parquet"
        write_recording(outcome.recording, path)
    return {name: dataclasses.asdict(out.score) for name, out in outcomes.items()}
