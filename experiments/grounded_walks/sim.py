"""The sim that gaits walk in, behind an action transformer if it is grounded."""

import contextlib
from dataclasses import dataclass, field

import numpy as np

import robots
from experiments.grounded_walks.courses import SimPlace, world_at
from experiments.grounded_walks.data import WALK
from experiments.walking.trials import TrialRules, Trials, walk_trials
from groundwalk.arrays import FloatArray
from sgat.transformers.transformer import Transformer
from sgat.walks.walk_senses import leg_senses
from sgat.walks.wrapped_worlds import GroundedWorld

ROBOT = "nao"
"""Name of the robot that walks in all studies with grounded sims."""


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

    By default all gaits get the same random numbers, so that differences between their
    results come from the gaits alone.

    Args:
      sim: grounded or not.
      vectors: (gaits, 16) in the units of `walk_engine.PARAMETERS`.
      repeats: walks of each gait.
      seed: seed of grounds, start poses and the transformer's noise.
      rules: when a walk is over.
      own_seeds: whether every gait gets random numbers of its own instead.

    Returns:
      gaits * repeats trials; those of one gait follow each other.

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
