"""The sim that gaits walk in: grounded or not, flat or as uneven as real."""

from dataclasses import dataclass

import numpy as np

import robots
import terrain
import worlds
from experiments.trials import TrialRules, Trials, walk_trials
from experiments.walk_data import WALK, leg_senses
from groundwalk.arrays import FloatArray
from sgat.action_transformer import Transformer
from sgat.grounded_world import GroundedWorld
from terrain import Heightfield
from worlds import World, WorldOptions

ROBOT = "nao"

LUMPS_M = (0.002, 0.005, 0.008, 0.011, 0.014)
"""Amplitudes of an uneven sim's lumps."""

SHORT_START_M = 0.1
"""Flat ground around the start of short walks: they shall not spend half of their time
on it."""


@dataclass(frozen=True)
class GroundedSim:
    """The sim that gaits walk in.

    Attributes:
      transformer: of the commands; None for the sim as it is.
      lumps_m: amplitude of the lumps that it has. Where 0 it is flat, and its sensors
        have no noise; else they are as noisy as the real world's.
      start_m: radius of the flat ground around the start.
    """

    transformer: Transformer | None = None
    lumps_m: float = 0.0
    start_m: float = 0.35

    def ground(self, seed: np.random.SeedSequence) -> Heightfield:
        """One ground, the lumps as long as the real world's."""
        if not self.lumps_m:
            return terrain.make("flat", 0)
        sizes = {"amplitude_m": self.lumps_m, "start_radius_m": self.start_m}
        return terrain.make("lumps", seed, **sizes)

    @property
    def options(self) -> WorldOptions:
        """Of the world inside."""
        return noisy_sim() if self.lumps_m else worlds.kind("sim").options


def noisy_sim() -> WorldOptions:
    """The sim's options, but with the real world's sensors."""
    noise = worlds.kind("real").options.noise
    return WorldOptions(worlds.kind("sim").options.timestep_s, noise=noise)


def any_lumps(seed: np.random.SeedSequence) -> Heightfield:
    """A ground with lumps of one of `LUMPS_M`."""
    which = np.random.default_rng(seed).integers(len(LUMPS_M))
    return GroundedSim(lumps_m=LUMPS_M[which], start_m=SHORT_START_M).ground(seed)


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
        grounds = [sim.ground(child) for child in seeds]
    else:
        seeds = seed.spawn(repeats) * len(vectors)
        grounds = [sim.ground(child) for child in seeds[:repeats]] * len(vectors)
    robot = robots.get(ROBOT)
    world: World = worlds.make("sim", robot, grounds, seeds, sim.options)
    if sim.transformer is not None:
        senses = leg_senses(world.description)
        world = GroundedWorld(world, senses, sim.transformer, seeds)
    return walk_trials(world, np.repeat(vectors, repeats, axis=0), rules, seeds)
