"""Trials of the terrain stress test: gaits walk on ground of one severity."""

import contextlib
import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import robots
import worlds
from experiments.stress.fall_cause import fall_cause
from experiments.stress.families import Place, leg_length_m
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.recorder import Recorder, servo_gains
from experiments.walking.trials import TrialRules, walk_trials
from groundwalk.gravity import GRAVITY_M_S2
from robots import Description
from terrain import TerrainSpec
from walk_engine import Gait
from worlds import FALLS, End, RecordingMetadata
from worlds.scenes.scene import Scene

COURSE_LEGS = 8.0
"""Length of a trial's course in leg lengths; 2 m for the NAO."""

LIMIT_PENDULUMS = 50.0
"""Time limit of a trial in units of sqrt(leg length / gravity); 8 s for the NAO."""

BEGIN_LEGS = (0.8, 1.6)
"""Range [leg lengths] from which each trial's flat area around the start is drawn."""

START_SPREAD_RAD = 0.01
"""Standard deviation of the joint angles in the start poses [rad], so that trials
differ."""

Row = tuple[str, int]
"""Name of a gait, and number of a trial of it."""


@dataclass(frozen=True)
class Trial:
    """The result of one trial.

    Attributes:
      gait: name of the gait.
      number: number of the trial; trials with the same number have the same ground,
        noise and start pose.
      distance_m: distance forward at the end [m].
      time_s: duration [s].
      end: reason of an early end, such as "fall"; "" if the time was up or the course
        finished.
      cause: cause of the fall; "" without a fall.
    """

    gait: str
    number: int
    distance_m: float
    time_s: float
    end: str
    cause: str

    @property
    def fell(self) -> bool:
        """Whether the robot fell; a diverged simulation counts as a fall."""
        return self.end in FALLS


@dataclass(frozen=True, eq=False)
class Walk:
    """A trial with its recording."""

    trial: Trial
    scene: Scene


@dataclass(frozen=True, eq=False)
class _Start:
    """Ground and seeds of a trial, which are the same for all gaits."""

    ground: TerrainSpec
    of_noise: np.random.SeedSequence
    of_pose: np.random.SeedSequence


def rules_of(description: Description) -> TrialRules:
    """Rules of a trial, with course and time limit scaled to the robot's leg length."""
    leg_m = leg_length_m(description)
    return TrialRules(
        limit_s=round(LIMIT_PENDULUMS * math.sqrt(leg_m / GRAVITY_M_S2), 2),
        course_m=COURSE_LEGS * leg_m,
        start_spread_rad=START_SPREAD_RAD,
    )


def walk_at(
    place: Place,
    gaits: Mapping[str, Gait],
    rows: Sequence[Row],
    seed: int,
    threads: int = 0,
    on_end: Callable[[], object] = lambda: None,
) -> Iterator[Walk]:
    """Run trials at a place; none depends on which other trials run beside it.

    Args:
      place: robot, world, family of ground and severity.
      gaits: the gaits by name.
      rows: gait and number of every trial.
      seed: the random numbers of a trial follow from it and from the trial's number.
      threads: threads of the sim, or processes of the real world; 0 for one per core.
      on_end: called once at the end of each trial.
    """
    for first in range(0, len(rows), MOST_AT_ONCE):
        wave = rows[first : first + MOST_AT_ONCE]
        yield from _walk_together(place, gaits, wave, seed, threads, on_end)


def _walk_together(
    place: Place,
    gaits: Mapping[str, Gait],
    rows: Sequence[Row],
    seed: int,
    threads: int,
    on_end: Callable[[], object],
) -> Iterator[Walk]:
    description = robots.get(place.robot)
    numbers = dict.fromkeys(number for _, number in rows)
    starts = {number: _start(place, description, number, seed) for number in numbers}
    grounds = {number: start.ground.make() for number, start in starts.items()}
    usual = dataclasses.replace(worlds.kind(place.world).options, threads=threads)
    own = [starts[number] for _, number in rows]
    world = worlds.make(
        place.world,
        description,
        [grounds[number] for _, number in rows],
        [start.of_noise for start in own],
        place.options(usual),
    )
    recorder = Recorder(description, range(len(rows)))
    with contextlib.closing(world):
        trials = walk_trials(
            world,
            [gaits[name] for name, _ in rows],
            rules_of(description),
            [start.of_pose for start in own],
            recorder,
            on_end,
        )
    for i, (name, number) in enumerate(rows):
        end = trials.ended[i]
        about = _metadata(place, description, own[i].ground, gaits[name], end)
        scene = Scene(
            f"{place.world}/{name}/{place.label}",
            recorder.recording(i, about),
            description,
            grounds[number],
        )
        trial = Trial(
            gait=name,
            number=number,
            distance_m=float(trials.distance_m[i]),
            time_s=float(trials.time_s[i]),
            end=str(end),
            cause=str(fall_cause(scene).cause) if trials.fell[i] else "",
        )
        yield Walk(trial, scene)


def _start(place: Place, description: Description, number: int, seed: int) -> _Start:
    """Draw ground and seeds of a trial; the seeds are the same at all severities."""
    children = np.random.SeedSequence(seed, spawn_key=(number,)).spawn(4)
    of_ground, of_begin, of_noise, of_pose = children
    begin = float(np.random.default_rng(of_begin).uniform(*BEGIN_LEGS))
    ground_seed = int(of_ground.generate_state(1)[0])
    ground = place.ground(leg_length_m(description), begin, ground_seed)
    return _Start(ground, of_noise, of_pose)


def _metadata(
    place: Place, description: Description, ground: TerrainSpec, gait: Gait, end: End
) -> RecordingMetadata:
    return RecordingMetadata(
        robot=description.name,
        base="floating",
        source=f"groundwalk terrain-stress, {place.world} world, {place.label}",
        servo=servo_gains(description),
        terrain=ground.to_json(),
        gait=dict(gait),
        world=place.world,
        end=str(end),
    )
