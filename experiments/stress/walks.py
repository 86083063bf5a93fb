"""Trials of the terrain stress test: gaits walk on ground of one severity."""

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

import robots
import worlds
from experiments.stress.fall_cause import fall_cause
from experiments.stress.families import Place, leg_length_m
from experiments.walking.evaluation import MOST_AT_ONCE, Start, walk_recorded
from experiments.walking.trials import TrialRules
from groundwalk.gravity import GRAVITY_M_S2
from robots import Description
from walk_engine import Gait
from worlds import FALLS
from worlds.scenes.scene import Scene

COURSE_LEGS = 8.0
"""Length of a trial's course in leg lengths; 2 m for the NAO."""

LIMIT_PENDULUMS = 50.0
"""Time limit of a trial in units of sqrt(leg length / gravity); 8 s for the NAO."""

BEGIN_LEGS = (0.8, 1.6)
"""Range [leg lengths] of the radius of each trial's flat area around the start."""

START_SPREAD_RAD = 0.01
"""Standard deviation of the joint angles in the start poses [rad], so that trials
differ."""

Row = tuple[str, int]
"""Name of a gait, and number of a trial of it."""


@dataclass(frozen=True)
class Trial:
    """The result of one trial: distance forward at the end, and duration.

    Trials with the same number have the same ground, noise and start pose. `end` is the
    reason of an early end, such as "fall", else ""; so is the cause without a fall.
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
) -> Iterator[tuple[Trial, Scene]]:
    """Run trials at a place, and record them; none depends on the others beside it.

    The random numbers of a trial follow from the seed and the trial's number. `threads`
    are those of the sim, or processes of the real world; 0 is one per core. `on_end` is
    called at the end of each trial.
    """
    description = robots.get(place.robot)
    options = place.options(
        dataclasses.replace(worlds.kind(place.world).options, threads=threads)
    )
    source = f"groundwalk terrain-stress, {place.world} world, {place.label}"
    for first in range(0, len(rows), MOST_AT_ONCE):
        wave = rows[first : first + MOST_AT_ONCE]
        numbers = dict.fromkeys(number for _, number in wave)
        starts = {n: _start(place, description, n, seed) for n in numbers}
        own = [(gaits[name], starts[number]) for name, number in wave]
        world = worlds.make(
            place.world,
            description,
            [start.ground for _, start in own],
            [start.of_noise for _, start in own],
            options,
        )
        trials, recordings = walk_recorded(
            world,
            own,
            rules_of(description),
            range(len(wave)),
            (place.world, source),
            on_end,
        )
        for i, (name, number) in enumerate(wave):
            scene = Scene(
                f"{place.world}/{name}/{place.label}",
                recordings[i],
                description,
                starts[number].ground,
            )
            trial = Trial(
                gait=name,
                number=number,
                distance_m=float(trials.distance_m[i]),
                time_s=float(trials.time_s[i]),
                end=str(trials.ended[i]),
                cause=str(fall_cause(scene).cause) if trials.fell[i] else "",
            )
            yield trial, scene


def _start(place: Place, description: Description, number: int, seed: int) -> Start:
    """Draw ground and seeds of a trial; the seeds are the same at all severities."""
    children = np.random.SeedSequence(seed, spawn_key=(number,)).spawn(4)
    of_ground, of_begin, of_noise, of_pose = children
    begin = float(np.random.default_rng(of_begin).uniform(*BEGIN_LEGS))
    ground_seed = int(of_ground.generate_state(1)[0])
    spec = place.ground(leg_length_m(description), begin, ground_seed)
    return Start(spec, spec.make(), of_noise, of_pose)
