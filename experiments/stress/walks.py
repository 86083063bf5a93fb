"""Trials of the terrain stress test: gaits walk at a place, and how each trial went."""

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
"""Length of the course in leg lengths; on the NAO 2 m."""

LIMIT_PENDULUMS = 50.0
"""Time limit in sqrt(leg length / gravity); on the NAO 8 s."""

BEGIN_LEGS = (0.8, 1.6)
"""How far from the start the ground may begin to be what it is, in leg lengths."""

START_SPREAD_RAD = 0.01
Row = tuple[str, int]
"""Name of a gait, and number of its trial."""


@dataclass(frozen=True)
class Trial:
    """How one trial went.

    Attributes:
      gait: its name.
      number: trials of one number have the same ground, noise and start pose.
      distance_m: forward, until the end.
      time_s: until the end.
      end: why the rollout ended; empty if time was up or the course done.
      cause: what came before the fall, if there was one.
    """

    gait: str
    number: int
    distance_m: float
    time_s: float
    end: str
    cause: str

    @property
    def fell(self) -> bool:
        """Whether the robot fell; physics that blew up counts as a fall."""
        return self.end in FALLS


@dataclass(frozen=True, eq=False)
class Walk:
    """A trial with what was recorded of it."""

    trial: Trial
    scene: Scene


@dataclass(frozen=True, eq=False)
class _Start:
    """What is given at the start of a trial, whatever the gait."""

    ground: TerrainSpec
    of_noise: np.random.SeedSequence
    of_pose: np.random.SeedSequence


def rules_of(description: Description) -> TrialRules:
    """A course of 8 legs' length, in a time that grows as a pendulum's period does."""
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
    """Let gaits walk at a place; each trial has the same bits whatever the others are.

    Args:
      place: where.
      gaits: by name.
      rows: gait and number of every trial.
      seed: of all randomness; a trial's depends on it and on the trial's number.
      threads: of the sim, or processes of the real world; 0 for one per core.
      on_end: called once for each trial that is over.
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
    """A trial's ground, noise and pose: the same at all severities, for all gaits."""
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
