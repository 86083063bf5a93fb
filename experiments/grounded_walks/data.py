"""What the models of a grounding learn from: walks in either world."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from experiments.grounded_walks.courses import RealCourse, SimPlace, world_at
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.trials import TrialRules, Trials, walk_trials
from groundwalk.arrays import FloatArray
from robots import Description, biped
from sgat.transitions import Transitions
from sgat.walks.walk_senses import WalkSenses
from sgat.walks.watched_world import WatchedWorld
from walk_engine import Gait
from walk_engine.gait import NAMES, from_unit, to_unit

WALK = TrialRules(limit_s=7.5, start_spread_rad=0.01)
"""A walk of the paper's length, from a start pose that spreads."""


@dataclass(frozen=True)
class GaitCloud:
    """Random gaits around one, at speeds of their own.

    Attributes:
      spread: standard deviation, as a part of each parameter's range.
      slowest_m_s: least speed asked for.
      fastest_m_s: largest speed asked for.
    """

    spread: float = 0.12
    slowest_m_s: float = 0.12
    fastest_m_s: float = 0.40

    def draw(
        self, around: Gait, count: int, seed: np.random.SeedSequence
    ) -> FloatArray:
        """(count, 16) gait vectors."""
        rng = np.random.default_rng(seed)
        unit = to_unit(around.to_vector()) + rng.normal(0, self.spread, (count, 16))
        vectors = from_unit(np.clip(unit, 0.02, 0.98))
        speeds = rng.uniform(self.slowest_m_s, self.fastest_m_s, count)
        vectors[:, NAMES.index("max_forward")] = speeds
        return vectors


def leg_senses(description: Description) -> WalkSenses:
    """Senses that ground the legs: arms hardly matter, and their data cost."""
    legs = biped(description)
    return WalkSenses([*legs.left_leg, *legs.right_leg])


ON_COURSE = TrialRules(limit_s=15.0, start_spread_rad=0.01)
"""As long as a course of 3 m takes."""

FLAT_TICKS = 300
"""The ground around the start is flat: what a robot does there says nothing of lumps,
and a grounding that averages over both falls too seldom."""


def walk(
    place: RealCourse | SimPlace,
    description: Description,
    vectors: FloatArray,
    seed: np.random.SeedSequence,
    exploration_rad: Sequence[float] = (0.0,),
    rules: TrialRules = WALK,
) -> tuple[Trials, Transitions]:
    """Each gait walks once, on ground of its own; everything is noted.

    Args:
      place: the world and its grounds.
      description: the robot.
      vectors: (n, 16) gaits.
      seed: of grounds, noise, start poses and exploration.
      exploration_rad: noise on the commands; the gaits get them in turn.
      rules: when a walk is over.
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
    """Walks without what was noted on the flat ground that they start from."""
    first = np.searchsorted(walks.episode, walks.episode)
    return walks.subset(np.arange(walks.n) - first >= FLAT_TICKS)
