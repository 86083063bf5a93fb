"""The sim that gaits walk in, behind a transformer where it is grounded."""

from dataclasses import dataclass, field

import numpy as np

import robots
from experiments.grounded_walks.courses import SimPlace, world_at
from experiments.grounded_walks.data import WALK, leg_senses
from experiments.walking.trials import TrialRules, Trials, walk_trials
from groundwalk.arrays import FloatArray
from sgat.transformers.action_transformer import Transformer
from sgat.walks.grounded_world import GroundedWorld

ROBOT = "nao"


@dataclass(frozen=True)
class GroundedSim:
    """The sim that gaits walk in.

    Attributes:
      transformer: of the commands; None for the sim as it is.
      place: the sim behind it.
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
    """Each gait walks several times in the grounded sim, gait by gait.

    All gaits get the same random numbers, so that differences are the gaits' own.

    Args:
      sim: grounded or not.
      vectors: (gaits, 16).
      repeats: walks of each gait.
      seed: of grounds, start poses and the transformer's noise.
      rules: when a walk is over.
      own_seeds: every gait gets random numbers of its own instead.
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
    return walk_trials(world, np.repeat(vectors, repeats, axis=0), rules, seeds)
