"""Raters of gaits for a search: each lets them walk in one world and gives rewards."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import robots
import terrain
import worlds
from experiments.grounded_walks.courses import RealCourse
from experiments.grounded_walks.data import ON_COURSE
from experiments.grounded_walks.sim import ROBOT, GroundedSim, walk_in_sim
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.trials import TrialRules, Trials, reward_cm_s, walk_trials
from groundwalk.arrays import FloatArray
from terrain import Heightfield
from worlds import WorldOptions

RATED = TrialRules(limit_s=7.5, start_spread_rad=0.01)
"""Rules of a walk that is rated: it lasts 7.5 s, as in searches in the plain sim; start
poses vary by 0.01 rad per joint (standard deviation)."""

FALL_PENALTY_WALK_CM_S = 60.0
"""Cost of a fall in a rated walk [cm/s]: four times the SGAT paper's 15. With 15, a
gait of 25 cm/s that falls on every second course is worth as much as one of 18 cm/s
that hardly ever falls; and the courses of 3 m take more than twice as long."""

REAL_GROUNDS = 10
"""Number of grounds for a generation of a search in the real world: on a single ground
all gaits may fall, or none."""


@dataclass(frozen=True)
class GroundedRater:
    """Rates gaits in the sim, grounded or not.

    Attributes:
      sim: the sim, with its action transformer if it is grounded.
      repeats: number of walks of each gait.
      rules: when a walk is over.
    """

    sim: GroundedSim
    repeats: int
    rules: TrialRules = RATED

    def __call__(self, vectors: FloatArray, seed: np.random.SeedSequence) -> FloatArray:
        """(n,) mean rewards [cm/s] of gaits (n, 16), with randomness from a seed."""
        trials = walk_in_sim(self.sim, vectors, self.repeats, seed, self.rules)
        rewards = _reward_cm_s(trials, self.rules)
        return np.asarray(rewards.reshape(len(vectors), -1).mean(axis=1))


@dataclass(frozen=True)
class RandomisedRater:
    """Rates gaits in the sim with random dynamics: dynamics randomisation.

    Attributes:
      repeats: number of walks of each gait, each in other dynamics.
      latency_s: least and largest time until a command takes effect [s].
      friction: least and largest coefficient between sole and ground.
    """

    repeats: int
    latency_s: tuple[float, float] = (0.0, 0.06)
    friction: tuple[float, float] = (0.4, 1.0)

    def __call__(self, vectors: FloatArray, seed: np.random.SeedSequence) -> FloatArray:
        """(n,) mean rewards [cm/s] of gaits (n, 16), with randomness from a seed."""
        grounds = [terrain.make("flat", 0)] * len(vectors)
        rewards = []
        for child in seed.spawn(self.repeats):
            options = self.options(np.random.default_rng(child))
            trials = _walk("sim", vectors, grounds, child, options)
            rewards.append(_reward_cm_s(trials))
        return np.asarray(np.mean(rewards, axis=0))

    def options(self, rng: np.random.Generator) -> WorldOptions:
        """Options of the sim with random latency and friction, and noisy sensors."""
        step_s = worlds.kind("sim").options.timestep_s
        latency_s = step_s * round(rng.uniform(*self.latency_s) / step_s)
        noise = worlds.kind("real").options.noise
        return WorldOptions(
            step_s, latency_s, noise, friction=rng.uniform(*self.friction)
        )


@dataclass(frozen=True)
class RealRater:
    """Rates gaits in the real world, with one walk of 15 s each.

    A search with it shows how good a gait could be if real walks cost nothing.

    Attributes:
      course: the ground, and the physics that the sim lacks.
    """

    course: RealCourse

    def __call__(self, vectors: FloatArray, seed: np.random.SeedSequence) -> FloatArray:
        """(n,) rewards [cm/s] of gaits (n, 16), with randomness from a seed."""
        grounds = self.course.grounds(seed.spawn(REAL_GROUNDS))
        trials = []
        for first in range(0, len(vectors), MOST_AT_ONCE):
            some = vectors[first : first + MOST_AT_ONCE]
            under = [grounds[i % REAL_GROUNDS] for i in range(len(some))]
            options = self.course.options
            trials.append(_walk("real", some, under, seed, options, ON_COURSE))
        return _reward_cm_s(Trials.joined(trials), ON_COURSE)


def _walk(
    world_name: str,
    vectors: FloatArray,
    grounds: Sequence[Heightfield],
    seed: np.random.SeedSequence,
    options: WorldOptions,
    rules: TrialRules = RATED,
) -> Trials:
    """Let every gait (n, 16) walk once, all with the same noise and start pose."""
    seeds: Sequence[np.random.SeedSequence] = [seed] * len(vectors)
    world = worlds.make(world_name, robots.get(ROBOT), grounds, seeds, options)
    try:
        return walk_trials(world, vectors, rules, seeds)
    finally:
        world.close()


def _reward_cm_s(trials: Trials, rules: TrialRules = RATED) -> FloatArray:
    return reward_cm_s(trials, rules.limit_s, FALL_PENALTY_WALK_CM_S)
