"""Walks in either world: what a grounding learns from them, and ratings for searches.

A rating lets gaits walk in one world and gives their rewards.
"""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import NamedTuple

import numpy as np

import robots
import terrain
import worlds
from experiments.grounded_walks.courses import (
    LUMPS_M,
    Places,
    RealCourse,
    SimPlace,
    world_at,
)
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.trials import TrialRules, Trials, reward_cm_s, walk_trials
from groundwalk.arrays import BoolArray, FloatArray
from robots import Description
from sgat.noise import child_of
from sgat.transformers.catalogue import Transformer
from sgat.transitions import Transitions
from sgat.walks.walk_senses import leg_senses
from sgat.walks.wrapped_worlds import GroundedWorld, WatchedWorld
from terrain import Heightfield
from worlds import WorldOptions

ROBOT = "nao"
"""Name of the robot that walks in all studies with grounded sims."""

WALK = TrialRules(limit_s=7.5, start_spread_rad=0.01)
"""Rules of a walk of 7.5 s, as in the SGAT paper. Joint positions at the start vary by
0.01 rad (standard deviation)."""

ON_COURSE = TrialRules(limit_s=15.0, start_spread_rad=0.01)
"""Rules of a walk of 15 s, the time for a course of 3 m at 20 cm/s."""

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
    """Let each gait (n, 16) walk once, on ground of its own; record all transitions.

    The gaits get noise on the joint commands with the standard deviations
    `exploration_rad` in turn; everything random follows from the seed. The transitions
    are in the order of the walks.

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


EXPLORATION_RAD = (0.0, 0.01, 0.02, 0.04)
"""Standard deviations [rad] of the noise on commands in the sim; the walks get them in
turn. Without noise, data do not show the effect of a single action."""

REAL_EXPLORATION_RAD = (0.0, 0.03)
"""Standard deviations [rad] of the noise on commands in the real world: every second
walk has noise. Gaits change commands smoothly: from walks without noise, models learned
half of the true latency of the roll joints."""


class RealWalks(NamedTuple):
    """Transitions of the real world, without those on the flat ground around the start.

    `vectors` (n, 16) are the gaits without noise on commands, and `fell` their falls.
    """

    noted: Transitions
    vectors: FloatArray
    fell: BoolArray


class WalkRecords(NamedTuple):
    """Walks of the real world, and transitions of the flat and of the uneven sim.

    The uneven sim has lumps of all sizes, and sensors as noisy as the real world's.
    """

    real: RealWalks
    sim: Transitions
    uneven: Transitions

    def joined(self, other: "WalkRecords") -> "WalkRecords":
        """The walks of both in one object: first these, then those of `other`."""
        real, more = self.real, other.real
        return WalkRecords(
            RealWalks(
                real.noted.joined(more.noted),
                np.vstack([real.vectors, more.vectors]),
                np.concatenate([real.fell, more.fell]),
            ),
            self.sim.joined(other.sim),
            self.uneven.joined(other.uneven),
        )


def record_real(
    vectors: FloatArray, seed: np.random.SeedSequence, course: RealCourse
) -> RealWalks:
    """Let gaits (n, 16) walk in the real world, with all randomness from the seed."""
    exploration, robot = REAL_EXPLORATION_RAD, robots.get(ROBOT)
    trials, real = walk(
        course, robot, vectors, child_of(seed, 0), exploration, ON_COURSE
    )
    as_it_is = slice(None, None, len(exploration))
    return RealWalks(on_lumps(real), vectors[as_it_is], trials.fell[as_it_is])


def record_walks(
    real: RealWalks,
    of_sim: FloatArray,
    seed: np.random.SeedSequence,
    places: Places,
) -> WalkRecords:
    """Let gaits (n, 16) walk in the flat and the uneven sim, and add the real walks."""
    robot, in_sim, on_uneven = robots.get(ROBOT), child_of(seed, 1), child_of(seed, 2)
    _, flat = walk(places.sim(), robot, of_sim, in_sim, EXPLORATION_RAD)
    _, uneven = walk(places.sim(LUMPS_M), robot, of_sim, on_uneven, EXPLORATION_RAD)
    return WalkRecords(real, flat, uneven)


@dataclass(frozen=True)
class GroundedSim:
    """The sim that gaits walk in, grounded or not.

    Attributes:
      transformer: changes the joint commands; None leaves the sim as it is.
      place: the sim behind the transformer.

    Example:
      >>> GroundedSim(None, SimPlace()).transformer is None  # the plain sim
      True
    """

    transformer: Transformer | None = None
    place: SimPlace = field(default_factory=SimPlace)


def walk_in_sim(
    sim: GroundedSim,
    vectors: FloatArray,
    repeats: int,
    seed: np.random.SeedSequence,
    rules: TrialRules = WALK,
    own_seeds: bool = False,
) -> Trials:
    """Let each gait walk several times in a sim.

    All gaits (n, 16) get the same random numbers, so that differences between their
    results come from the gaits alone, or with `own_seeds` numbers of their own. They
    are for grounds, start poses and the transformer's noise. The repeats of one gait
    follow each other in the trials.

    Example:
      >>> trials = walk_in_sim(GroundedSim(), vectors, 2, np.random.SeedSequence(1))
    """
    if own_seeds:
        seeds = seed.spawn(repeats * len(vectors))
        grounds = sim.place.grounds(seeds)
    else:
        children = seed.spawn(repeats)
        seeds = children * len(vectors)
        grounds = sim.place.grounds(children) * len(vectors)
    world = world_at(sim.place, robots.get(ROBOT), grounds, seeds)
    if sim.transformer is not None:
        senses = leg_senses(world.description)
        world = GroundedWorld(world, senses, sim.transformer, seeds)
    with contextlib.closing(world):
        return walk_trials(world, np.repeat(vectors, repeats, axis=0), rules, seeds)


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
