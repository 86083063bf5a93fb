"""Trials: gaits walk straight ahead in a world until a fall or the time limit."""

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
    """The start pose, the time limit and the course of a trial.

    Attributes:
      limit_s: time limit [s].
      course_m: the trial ends after this distance forward [m]; None for no such end.
      start_spread_rad: standard deviation [rad] of the joint angles at the start around
        the gait's own start pose.

    Example:
      >>> TrialRules(limit_s=5.0, course_m=2.0)
      TrialRules(limit_s=5.0, course_m=2.0, start_spread_rad=0.0)
    """

    limit_s: float = 7.5
    course_m: float | None = None
    start_spread_rad: float = 0.0

    def __post_init__(self) -> None:
        """Refuse limits that are not positive, and a negative spread."""
        allowed = {"course_m": None, "start_spread_rad": 0}
        for name, value in vars(self).items():
            if name in allowed and value == allowed[name]:
                continue
            if not (math.isfinite(value) and value > 0):
                raise BadValueError(f"{name} is {value}; it must be positive")


SEARCH_TRIAL = TrialRules(limit_s=7.5)
"""Rules of a trial in a search: 7.5 s or until a fall, as in the NAO experiment of the
SGAT paper.

Example:
  >>> trials = walk_trials(world, gaits, SEARCH_TRIAL)
"""


def course(length_m: float) -> TrialRules:
    """Rules of a trial on a course of this length [m].

    There is time to walk it at 7.5 cm/s. Start poses vary by 0.01 rad (standard
    deviation), so that no two trials are alike.

    Raises:
      BadValueError: the length is not positive.

    Example:
      >>> course(3.0)
      TrialRules(limit_s=40.0, course_m=3.0, start_spread_rad=0.01)
    """
    if not length_m > 0:
        raise BadValueError(f"course_m is {length_m:g}; it must be positive")
    return TrialRules(length_m / 0.075, length_m, start_spread_rad=0.01)


COURSE_TRIAL = course(3.0)
"""Rules of a trial on a course of 3 m, as in the SGAT paper.

Example:
  >>> trials = walk_trials(world, gaits, COURSE_TRIAL)
"""


@dataclass(frozen=True, eq=False)
class Trials:
    """Distance, duration and end of n trials, as `walk_trials` returns them.

    Attributes:
      distance_m: (n,) distance [m] along the direction faced at the start.
      time_s: (n,) duration of the trial [s].
      ended: n reasons why the trial ended early, such as a fall; `End.NONE` if the
        time was up or the course finished.

    Example:
      >>> trials = Trials(np.array([0.5]), np.array([2.0]), (End.NONE,))
      >>> trials.speed_cm_s
      array([25.])
    """

    distance_m: FloatArray
    time_s: FloatArray
    ended: tuple[End, ...]

    def part(self, start: int, stop: int) -> "Trials":
        """The trials with index `start` to `stop - 1`."""
        rows = slice(start, stop)
        return Trials(self.distance_m[rows], self.time_s[rows], self.ended[rows])

    @classmethod
    def joined(cls, parts: Sequence["Trials"]) -> "Trials":
        """Concatenate the trials of several parts."""
        return cls(
            np.concatenate([part.distance_m for part in parts]),
            np.concatenate([part.time_s for part in parts]),
            tuple(end for part in parts for end in part.ended),
        )

    @property
    def speed_cm_s(self) -> FloatArray:
        """(n,) mean forward speed [cm/s] until the end of the trial."""
        return np.asarray(100 * self.distance_m / self.time_s)

    @property
    def fell(self) -> BoolArray:
        """(n,) whether the robot fell; a diverged simulation counts as a fall."""
        return np.array([end in FALLS for end in self.ended])


FALL_PENALTY_CM_S = 15.0
"""Penalty of a fall in the reward [cm/s], as in the SGAT paper's NAO experiment."""


def reward_cm_s(
    trials: Trials, limit_s: float, fall_penalty_cm_s: float = FALL_PENALTY_CM_S
) -> FloatArray:
    """(n,) rewards of trials for a search: forward speed minus a penalty for a fall.

    The speed is the distance over the whole time limit, even after a fall. If it were
    the speed until the fall, the search would prefer a sprint that ends in a fall.

    Example:
      >>> trials = Trials(np.array([0.5]), np.array([2.0]), (End.FALL,))
      >>> reward_cm_s(trials, limit_s=5.0)
      array([-5.])
    """
    progress = 100 * trials.distance_m / limit_s
    return np.asarray(progress - fall_penalty_cm_s * trials.fell)


def start_pose(
    engine: WalkEngine, rules: TrialRules, seeds: Sequence[np.random.SeedSequence]
) -> FloatArray:
    """(n, joints) angles [rad] at the start of trials of the engine's n gaits.

    The n seeds are not used if the rules do not spread the poses.
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
      world: a world with one robot for each gait.
      gaits: n gaits, or their vectors (n, 16).
      rules: start pose, time limit and course of a trial.
      seeds: n seeds of the start poses; needed only if the rules spread the poses.
      recorder: records every tick; None for no recording.
      on_end: called once at the end of each robot's trial.

    Example:
      >>> ground, seed = terrain.make("flat", seed=0), np.random.SeedSequence(1)
      >>> world = worlds.make("sim", robots.get("nao"), [ground], [seed])
      >>> walk_trials(world, [gaits.get("start")], TrialRules(limit_s=5.0)).fell
      array([False])
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
