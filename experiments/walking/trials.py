"""Trials: gaits that walk straight ahead in a world, until time is up or a fall."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from experiments.walking.recorder import Recorder
from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadValueError
from robots import biped
from walk_engine import Gait, Velocity, WalkEngine
from worlds import FALLS, TICK_S, End, World


@dataclass(frozen=True)
class TrialRules:
    """When a trial is over.

    Attributes:
      limit_s: time limit.
      course_m: the trial is finished after this distance forward; None for no end.
      start_spread_rad: standard deviation of the joints at the start around the
        gait's own pose; a robot never starts twice from the same one.
    """

    limit_s: float = 7.5
    course_m: float | None = None
    start_spread_rad: float = 0.0

    def __post_init__(self) -> None:
        """Refuse trials that cannot be."""
        for name, value in vars(self).items():
            if value is None and name == "course_m":
                continue
            positive = value > 0 or (value == 0 and name == "start_spread_rad")
            if not (math.isfinite(value) and positive):
                raise BadValueError(f"{name} is {value}; it must be positive")


SEARCH_TRIAL = TrialRules(limit_s=7.5)
"""A trial of the search: 7.5 s or until a fall (the SGAT paper, section on the NAO)."""

COURSE_TRIAL = TrialRules(limit_s=40.0, course_m=3.0, start_spread_rad=0.01)
"""A trial of the evaluation: a course of 3 m, as in the SGAT paper."""


@dataclass(frozen=True, eq=False)
class Trials:
    """How n trials went.

    Attributes:
      distance_m: (n,) forward, along the direction faced at the start.
      time_s: (n,) until the end of the trial.
      ended: why the rollout ended; `End.NONE` if time was up or the course done.
    """

    distance_m: FloatArray
    time_s: FloatArray
    ended: tuple[End, ...]

    def part(self, start: int, stop: int) -> "Trials":
        """Trials `start` to `stop - 1`."""
        rows = slice(start, stop)
        return Trials(self.distance_m[rows], self.time_s[rows], self.ended[rows])

    @classmethod
    def joined(cls, parts: Sequence["Trials"]) -> "Trials":
        """All trials of some parts, in their order."""
        return cls(
            np.concatenate([part.distance_m for part in parts]),
            np.concatenate([part.time_s for part in parts]),
            tuple(end for part in parts for end in part.ended),
        )

    @property
    def speed_cm_s(self) -> FloatArray:
        """(n,) mean forward speed until the end of the trial."""
        return np.asarray(100 * self.distance_m / self.time_s)

    @property
    def fell(self) -> BoolArray:
        """(n,) whether the robot fell; physics that blew up counts as a fall."""
        return np.array([end in FALLS for end in self.ended])


def start_pose(
    engine: WalkEngine, rules: TrialRules, seeds: Sequence[np.random.SeedSequence]
) -> FloatArray:
    """(n, joints) poses [rad] in which n trials begin.

    Args:
      engine: of n gaits.
      rules: how far the poses spread.
      seeds: n, if they do.
    """
    pose_rad = engine.start_pose()
    if rules.start_spread_rad == 0:
        return pose_rad
    joints = pose_rad.shape[1]
    spread = [np.random.default_rng(seed).standard_normal(joints) for seed in seeds]
    return pose_rad + rules.start_spread_rad * np.stack(spread)


def walk_trials(
    world: World,
    gaits: Sequence[Gait] | FloatArray,
    rules: TrialRules,
    seeds: Sequence[np.random.SeedSequence] = (),
    recorder: Recorder | None = None,
    on_end: Callable[[], object] = lambda: None,
) -> Trials:
    """Let every robot of a world walk straight ahead, as fast as its gait says.

    Args:
      world: one robot for each gait.
      gaits: n gaits, or their vectors (n, 16).
      rules: when a trial is over.
      seeds: n seeds for the poses at the start, if these shall spread.
      recorder: notes every tick.
      on_end: called once for each robot whose trial is over.
    """
    engine = WalkEngine(biped(world.description), gaits, TICK_S)
    observation = world.reset(start_pose(engine, rules, seeds))
    start_m = world.truth().base_position_m[:, 0]
    time_s = np.zeros(world.n)
    ahead = Velocity.forward()
    for _ in range(round(rules.limit_s / TICK_S)):
        walking = world.active
        command_rad = engine.step(
            ahead, observation.gyroscope_rad_s, observation.foot_force_n, walking
        )
        if recorder is not None:
            recorder.tick(
                observation, world.truth(), command_rad, engine.support, walking
            )
        observation = world.step(command_rad)
        time_s[walking] += TICK_S
        distance_m = world.truth().base_position_m[:, 0] - start_m
        if rules.course_m is not None:
            world.stop(distance_m >= rules.course_m)
        for _ in range(int((walking & ~world.active).sum())):
            on_end()
        if not world.active.any():
            break
    for _ in range(int(world.active.sum())):
        on_end()
    return Trials(distance_m, time_s, tuple(world.ended))
