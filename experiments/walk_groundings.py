"""The groundings of the walking robot that are compared."""

from dataclasses import dataclass

import numpy as np

import robots
import terrain
import worlds
from experiments.trials import TrialRules, Trials, walk_trials
from experiments.walk_data import WALK, leg_senses
from groundwalk.arrays import FloatArray, IntArray
from sgat.action_transformer import ActionTransformer, Transformer
from sgat.block_noise import BlockNoise
from sgat.forward_config import ForwardConfig
from sgat.forward_model import ForwardModel
from sgat.grounded_world import GroundedWorld
from sgat.inverse_model import InverseModel
from sgat.network_config import NetworkConfig
from sgat.noise import NoiseLaw, WhiteNoise
from sgat.realised_share import RealisedShare
from sgat.transitions import Transitions
from worlds import World

ROBOT = "nao"
NONE, GAT, SGAT, BLOCKS = "no grounding", "GAT", "SGAT", "SGAT, blocks"
GROUNDINGS = (NONE, GAT, SGAT, BLOCKS)

BLOCK_TICKS = 50
"""Two to three steps: a bump pushes all joints one way for several ticks."""

SHARE_RULES = TrialRules(limit_s=3.0, start_spread_rad=0.01)
LARGEST_ACTION_RAD = 1.0


@dataclass(frozen=True, eq=False)
class WalkModels:
    """Models of both worlds, and what the forward model does not explain.

    Attributes:
      forward: of the real world.
      inverse: of the sim; it sees the first columns of a state, without commands.
      residuals: (N, p) standardised, of the real walks.
      episode: (N,) which walk each belongs to.
    """

    forward: ForwardModel
    inverse: InverseModel
    residuals: FloatArray
    episode: IntArray

    def transformer(self, name: str, gain: float = 1.0) -> ActionTransformer | None:
        """The transformer of one of `GROUNDINGS`; None for no grounding.

        Args:
          name: which.
          gain: of the noise, for the one with blocks.
        """
        laws: dict[str, NoiseLaw | None] = {
            GAT: None,
            SGAT: WhiteNoise(self.forward.outcomes),
            BLOCKS: BlockNoise(self.residuals, self.episode, BLOCK_TICKS),
        }
        if name == NONE:
            return None
        senses = leg_senses(robots.get(ROBOT))
        bound = np.full(len(senses.joints), LARGEST_ACTION_RAD)
        return ActionTransformer(
            self.forward,
            self.inverse,
            -bound,
            bound,
            laws[name],
            gain=gain if name == BLOCKS else 1.0,
            inverse_columns=senses.sim_columns,
        )


def fit_models(
    real: Transitions, sim: Transitions, seed: np.random.SeedSequence
) -> WalkModels:
    """Fit the forward model to the real world and the inverse one to the sim."""
    of_forward, of_inverse = seed.spawn(2)
    columns = leg_senses(robots.get(ROBOT)).sim_columns
    seen = Transitions(sim.state[:, :columns], sim.action, sim.next_state, sim.episode)
    forward = ForwardModel(ForwardConfig(beta=0.5)).fit(real, of_forward)
    inverse = InverseModel(NetworkConfig()).fit(seen, of_inverse)
    return WalkModels(forward, inverse, forward.residuals(real), real.episode)


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


def calibrated_gain(
    models: WalkModels, vectors: FloatArray, seed: np.random.SeedSequence
) -> float:
    """One over the share of the joints' noise that the grounded sim realises.

    Measured in the sim alone, on gaits of the grounding's own data; no fall is
    looked at.
    """
    transformer = models.transformer(BLOCKS)
    assert transformer is not None
    probe = RealisedShare(transformer)
    walk_in_sim(probe, vectors, 1, seed, SHARE_RULES)
    joints = len(leg_senses(robots.get(ROBOT)).joints)
    return 1 / float(np.median(probe.share()[:joints]))
