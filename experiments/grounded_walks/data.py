"""Walks in either world, with the transitions that a grounding learns from."""

import contextlib
from collections.abc import Sequence
from functools import reduce

import numpy as np

from experiments.grounded_walks.courses import RealCourse, SimPlace, world_at
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.trials import TrialRules, Trials, walk_trials
from groundwalk.arrays import FloatArray
from robots import Description
from sgat.transitions import Transitions
from sgat.walks.walk_senses import leg_senses
from sgat.walks.wrapped_worlds import WatchedWorld

WALK = TrialRules(limit_s=7.5, start_spread_rad=0.01)
"""Rules of a walk of 7.5 s, as in the SGAT paper. Joint positions at the start vary by
0.01 rad (standard deviation)."""

ON_COURSE = TrialRules(limit_s=15.0, start_spread_rad=0.01)
"""Rules of a walk of 15 s, the time for a course of 3 m at 20 cm/s. Joint positions at
the start vary by 0.01 rad (standard deviation)."""

FLAT_TICKS = 300
"""Ticks (3 s) at the start of a real walk that a grounding does not learn from: the
ground is flat there, and a sim grounded on flat ground and lumps alike has fewer falls
than the real world."""


def walk(
    place: RealCourse | SimPlace,
    description: Description,
    vectors: FloatArray,
    seed: np.random.SeedSequence,
    exploration_rad: Sequence[float] = (0.0,),
    rules: TrialRules = WALK,
) -> tuple[Trials, Transitions]:
    """Let each gait walk once, on ground of its own, and record all transitions.

    Args:
      place: the world and its grounds.
      description: the robot.
      vectors: (n, 16) gaits, in the units of `walk_engine.PARAMETERS`.
      seed: seed of grounds, sensor noise, start poses and noise on commands.
      exploration_rad: standard deviations [rad] of noise on the joint commands; the
        gaits get them in turn.
      rules: when a walk is over.

    Returns:
      Results of the n walks, and their transitions in the same order.

    Example:
      >>> vectors = GaitCloud().draw(gaits.get("start"), 4, np.random.SeedSequence(1))
      >>> trials, noted = walk(SimPlace(), robots.get("nao"), vectors, seed)
    """
    levels = np.resize(np.asarray(exploration_rad, float), (len(vectors), 1))
    trials, noted = [], []
    children = seed.spawn(2 * len(vectors))
    for first in range(0, len(vectors), MOST_AT_ONCE):
        rows = slice(first, first + MOST_AT_ONCE)
        seeds = children[: len(vectors)][rows]
        world = WatchedWorld(
            world_at(place, description, place.grounds(seeds), seeds),
            leg_senses(description),
            levels[rows],
            children[len(vectors) + first],
        )
        with contextlib.closing(world):
            trials.append(walk_trials(world, vectors[rows], rules, seeds))
            noted.append(world.transitions())
    return Trials.joined(trials), reduce(Transitions.joined, noted)


def on_lumps(walks: Transitions) -> Transitions:
    """Walks without their first `FLAT_TICKS` ticks, which are on flat ground."""
    first = np.searchsorted(walks.episode, walks.episode)
    return walks.subset(np.arange(walks.n) - first >= FLAT_TICKS)
