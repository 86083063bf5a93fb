"""Walks in either world, and what a grounding learns from them."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import NamedTuple

import numpy as np

import robots
from experiments.grounded_walks.courses import (
    LUMPS_M,
    Places,
    RealCourse,
    SimPlace,
    world_at,
)
from experiments.walking.evaluation import MOST_AT_ONCE
from experiments.walking.trials import TrialRules, Trials, walk_trials
from groundwalk.arrays import BoolArray, FloatArray
from robots import Description
from sgat.noise import child_of
from sgat.transformers.catalogue import Transformer
from sgat.transitions import Transitions
from sgat.walks.walk_senses import leg_senses
from sgat.walks.wrapped_worlds import GroundedWorld, WatchedWorld

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
        """These walks, followed by those of another step."""
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
      See docs/python.md, "Learn with Gymnasium".
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
