"""The groundings of the walking robot that are compared."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

import robots
import terrain
import worlds
from experiments.trials import TrialRules, Trials, walk_trials
from experiments.walk_data import WALK, leg_senses
from groundwalk.arrays import FloatArray
from sgat.action_noise import ActionNoise
from sgat.action_transformer import ActionTransformer, Transformer
from sgat.block_noise import BlockNoise
from sgat.forward_config import ForwardConfig
from sgat.forward_model import ForwardModel
from sgat.grounded_world import GroundedWorld
from sgat.inverse_model import InverseModel
from sgat.network_config import NetworkConfig
from sgat.noise import NoiseLaw, WhiteNoise
from sgat.transitions import Transitions
from worlds import World

ROBOT = "nao"
NONE, GAT, SGAT = "no grounding", "GAT", "SGAT"
ENSEMBLE = "SGAT, ensemble"
GROUNDINGS = (NONE, GAT, SGAT, ENSEMBLE)

BLOCK_TICKS = 50
"""Two to three steps: a bump pushes all joints one way for several ticks."""

MEMBERS = 4
"""Networks of the ensemble: a search cannot live on the errors of a single one."""

LARGEST_ACTION_RAD = 1.0


@dataclass(frozen=True, eq=False)
class WalkModels:
    """Models of both worlds, each fitted when it is first needed.

    Attributes:
      real: walks in the real world.
      sim: walks in the sim.
      seed: of the trainings.
    """

    real: Transitions
    sim: Transitions
    seed: np.random.SeedSequence

    @cached_property
    def inverse(self) -> InverseModel:
        """Of the sim; it sees the first columns of a state, without commands."""
        columns, sim = leg_senses(robots.get(ROBOT)).sim_columns, self.sim
        seen = Transitions(
            sim.state[:, :columns], sim.action, sim.next_state, sim.episode
        )
        return InverseModel(NetworkConfig()).fit(seen, self._seed(0))

    @cached_property
    def forward(self) -> ForwardModel:
        """Of the real world."""
        return ForwardModel(ForwardConfig(beta=0.5)).fit(self.real, self._seed(1))

    @cached_property
    def ensemble(self) -> ForwardModel:
        """Of the real world; a robot keeps one member for a walk."""
        config = ForwardConfig(beta=0.5, members=MEMBERS)
        return ForwardModel(config).fit(self.real, self._seed(2))

    def transformer(self, name: str) -> ActionTransformer | None:
        """The transformer of one of `GROUNDINGS`; None for no grounding.

        The ensemble's noise are blocks of the real walks' residuals: with their memory,
        their tails, and what they have in common across joints and torso.
        """
        if name == NONE:
            return None
        noise: NoiseLaw | None = None
        forward = self.ensemble if name == ENSEMBLE else self.forward
        if name == ENSEMBLE:
            residuals = forward.residuals(self.real)
            noise = BlockNoise(residuals, self.real.episode, BLOCK_TICKS)
        elif name == SGAT:
            noise = WhiteNoise(forward.outcomes)
        senses = leg_senses(robots.get(ROBOT))
        bound = np.full(len(senses.joints), LARGEST_ACTION_RAD)
        columns = senses.sim_columns
        return ActionTransformer(
            forward, self.inverse, -bound, bound, noise, inverse_columns=columns
        )

    def _seed(self, use: int) -> np.random.SeedSequence:
        key = (*self.seed.spawn_key, use)
        return np.random.SeedSequence(self.seed.entropy, spawn_key=key)


def action_envelope(deviation_rad: float) -> ActionNoise:
    """White noise on the legs' commands: ANE's stand-in for a grounding."""
    joints = len(leg_senses(robots.get(ROBOT)).joints)
    bound = np.full(joints, LARGEST_ACTION_RAD)
    return ActionNoise(deviation_rad, -bound, bound)


def walk_in_sim(
    transformer: Transformer | None,
    vectors: FloatArray,
    repeats: int,
    seed: np.random.SeedSequence,
    rules: TrialRules = WALK,
) -> Trials:
    """Each gait walks several times in the grounded sim, gait by gait.

    All gaits get the same random numbers, so that differences are the gaits' own.

    Args:
      transformer: None for the sim as it is.
      vectors: (gaits, 16).
      repeats: walks of each gait.
      seed: of start poses and of the transformer's noise.
      rules: when a walk is over.
    """
    seeds = seed.spawn(repeats) * len(vectors)
    ground = terrain.make("flat", 0)
    world: World = worlds.make("sim", robots.get(ROBOT), [ground] * len(seeds), seeds)
    if transformer is not None:
        senses = leg_senses(world.description)
        world = GroundedWorld(world, senses, transformer, seeds)
    return walk_trials(world, np.repeat(vectors, repeats, axis=0), rules, seeds)
