"""Ratings of gaits for a search: each lets them walk in one world and gives rewards."""

import contextlib
from collections.abc import Sequence

import numpy as np

import robots
import terrain
import worlds
from experiments.grounded_walks.courses import RealCourse
from experiments.grounded_walks.data import (
    ON_COURSE,
    ROBOT,
    WALK,
    GroundedSim,
    walk_in_sim,
)
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.trials import TrialRules, Trials, reward_cm_s, walk_trials
from groundwalk.arrays import FloatArray
from terrain import Heightfield
from worlds import WorldOptions

FALL_PENALTY_WALK_CM_S = 60.0
"""Cost of a fall in a rated walk [cm/s]: four times the SGAT paper's 15. With 15, a
gait of 25 cm/s that falls on every second course is worth as much as one of 18 cm/s
that hardly ever falls; and the courses of 3 m take more than twice as long."""

REAL_GROUNDS = 10
"""Number of grounds for a generation of a search in the real world: on a single ground
all gaits may fall, or none."""

LATENCY_S, FRICTION = (0.0, 0.06), (0.4, 1.0)
"""Least and largest latency [s] and friction of random dynamics."""


def rate_in_sim(
    sim: GroundedSim,
    repeats: int,
    rules: TrialRules,
    vectors: FloatArray,
    seed: np.random.SeedSequence,
) -> FloatArray:
    """(n,) mean rewards [cm/s] of gaits (n, 16) in a sim, with several walks each."""
    trials = walk_in_sim(sim, vectors, repeats, seed, rules)
    rewards = _reward_cm_s(trials, rules)
    return np.asarray(rewards.reshape(len(vectors), -1).mean(axis=1))


def rate_randomised(
    repeats: int, vectors: FloatArray, seed: np.random.SeedSequence
) -> FloatArray:
    """(n,) mean rewards [cm/s] of gaits (n, 16) in sims with random dynamics.

    Each of the walks of a gait (`repeats`) is in other dynamics.
    """
    grounds = [terrain.make("flat", 0)] * len(vectors)
    rewards = []
    for child in seed.spawn(repeats):
        options = random_dynamics(np.random.default_rng(child))
        trials = _walk("sim", vectors, grounds, child, options, WALK)
        rewards.append(_reward_cm_s(trials, WALK))
    return np.asarray(np.mean(rewards, axis=0))


def random_dynamics(rng: np.random.Generator) -> WorldOptions:
    """Options of the sim with random latency and friction, and noisy sensors."""
    step_s = worlds.kind("sim").options.timestep_s
    latency_s = step_s * round(rng.uniform(*LATENCY_S) / step_s)
    noise = worlds.kind("real").options.noise
    return WorldOptions(step_s, latency_s, noise, friction=rng.uniform(*FRICTION))


def rate_on_real(
    course: RealCourse, vectors: FloatArray, seed: np.random.SeedSequence
) -> FloatArray:
    """(n,) rewards [cm/s] of gaits (n, 16) in the real world, one walk of 15 s each.

    A search with it shows how good a gait could be if real walks cost nothing.
    """
    grounds = course.grounds(seed.spawn(REAL_GROUNDS))
    trials = []
    for first in range(0, len(vectors), MOST_AT_ONCE):
        some = vectors[first : first + MOST_AT_ONCE]
        under = [grounds[i % REAL_GROUNDS] for i in range(len(some))]
        trials.append(_walk("real", some, under, seed, course.options, ON_COURSE))
    return _reward_cm_s(Trials.joined(trials), ON_COURSE)


def _walk(
    world_name: str,
    vectors: FloatArray,
    grounds: Sequence[Heightfield],
    seed: np.random.SeedSequence,
    options: WorldOptions,
    rules: TrialRules,
) -> Trials:
    """Let every gait (n, 16) walk once, all with the same noise and start pose."""
    seeds: Sequence[np.random.SeedSequence] = [seed] * len(vectors)
    world = worlds.make(world_name, robots.get(ROBOT), grounds, seeds, options)
    with contextlib.closing(world):
        return walk_trials(world, vectors, rules, seeds)


def _reward_cm_s(trials: Trials, rules: TrialRules) -> FloatArray:
    return reward_cm_s(trials, rules.limit_s, FALL_PENALTY_WALK_CM_S)
