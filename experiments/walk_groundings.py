"""The groundings of the walking robot that are compared."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

import robots
import terrain
import worlds
from experiments.trials import TrialRules, Trials, walk_trials
from experiments.walk_data import WALK, leg_senses
from groundwalk.arrays import BoolArray, FloatArray
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
from terrain import Heightfield
from worlds import World

ROBOT = "nao"
NONE, GAT, SGAT = "no grounding", "GAT", "SGAT"
ENSEMBLE, UNEVEN = "SGAT, ensemble", "SGAT, uneven sim"
GROUNDINGS = (NONE, GAT, SGAT, ENSEMBLE, UNEVEN)

BLOCK_TICKS = 50
"""Two to three steps: a bump pushes all joints one way for several ticks."""

MEMBERS = 4
"""Networks of the ensemble: a search cannot live on the errors of a single one."""

LARGEST_ACTION_RAD = 1.0


LUMPS_M = (0.002, 0.005, 0.008, 0.011, 0.014)
"""Amplitudes of the sim's lumps that are tried."""

LOOKED_AT = 48
"""Real walks that are walked again in the sim to find the amplitude."""


@dataclass(frozen=True, eq=False)
class Walked:
    """Walks in the real world: who fell.

    Attributes:
      vectors: (n, 16) gaits.
      fell: (n,) whether each fell.
      rules: of the walks.
    """

    vectors: FloatArray
    fell: BoolArray
    rules: TrialRules


@dataclass(frozen=True)
class GroundedSim:
    """The sim that gaits walk in.

    Attributes:
      transformer: of the commands; None for the sim as it is.
      lumps_m: amplitude of the lumps that it has; flat where 0.
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


@dataclass(frozen=True, eq=False)
class WalkModels:
    """Models of both worlds, each fitted when it is first needed.

    Attributes:
      real: walks in the real world.
      sim: walks in the sim.
      seed: of the trainings.
      walked: how walks in the real world ended.
    """

    real: Transitions
    sim: Transitions
    seed: np.random.SeedSequence
    walked: Walked

    @cached_property
    def inverse(self) -> InverseModel:
        """Of the sim; it sees the first columns of a state, without commands."""
        return self._inverse(self.sim.next_state, self._seed(0))

    @cached_property
    def calm_inverse(self) -> InverseModel:
        """Of the sim, for next states that are as wrong as predicted ones are.

        A joint gets to a part of its command in a tick, so an inverse blows errors of
        a prediction up, the encoders' noise among them. An inverse that has met such
        errors does not believe them.
        """
        rng = np.random.default_rng(self._seed(3))
        rows = rng.choice(self.real.n, min(self.real.n, 30_000), replace=False)
        some = self.real.subset(np.sort(rows))
        wrong = self.forward.predict(some.state, some.action) - some.next_state
        spread = np.sqrt(np.mean(wrong**2, axis=0))
        reached = self.sim.next_state
        noise = spread * rng.standard_normal(reached.shape)
        return self._inverse(reached + noise, self._seed(4))

    @cached_property
    def lumps_m(self) -> float:
        """Amplitude at which the gaits of the real walks fall as often in the sim."""
        walked, shares = self.walked, []
        vectors = walked.vectors[:LOOKED_AT]
        for lumps_m in LUMPS_M:
            sim = GroundedSim(self._calm_transformer(), lumps_m)
            trials = walk_in_sim(sim, vectors, 1, self._seed(5), walked.rules, True)
            shares.append(trials.fell.mean())
        rising = np.maximum.accumulate(shares)
        return float(np.interp(walked.fell.mean(), rising, LUMPS_M))

    @cached_property
    def forward(self) -> ForwardModel:
        """Of the real world."""
        return ForwardModel(ForwardConfig(beta=0.5)).fit(self.real, self._seed(1))

    @cached_property
    def ensemble(self) -> ForwardModel:
        """Of the real world; a robot keeps one member for a walk."""
        config = ForwardConfig(beta=0.5, members=MEMBERS)
        return ForwardModel(config).fit(self.real, self._seed(2))

    def grounded(self, name: str) -> GroundedSim:
        """The sim of one of `GROUNDINGS`.

        The ensemble's noise are blocks of the real walks' residuals: with their memory,
        their tails, and what they have in common across joints and torso. The uneven
        sim has lumps of its own: commands on flat ground cannot make a robot trip.
        """
        if name == NONE:
            return GroundedSim()
        if name == UNEVEN:
            return GroundedSim(self._calm_transformer(), self.lumps_m)
        noise: NoiseLaw | None = None
        forward = self.ensemble if name == ENSEMBLE else self.forward
        if name == ENSEMBLE:
            residuals = forward.residuals(self.real)
            noise = BlockNoise(residuals, self.real.episode, BLOCK_TICKS)
        elif name == SGAT:
            noise = WhiteNoise(forward.outcomes)
        return GroundedSim(_transformer(forward, self.inverse, noise))

    def _calm_transformer(self) -> ActionTransformer:
        noise = WhiteNoise(self.forward.outcomes)
        return _transformer(self.forward, self.calm_inverse, noise)

    def _inverse(
        self, reached: FloatArray, seed: np.random.SeedSequence
    ) -> InverseModel:
        columns, sim = leg_senses(robots.get(ROBOT)).sim_columns, self.sim
        seen = Transitions(sim.state[:, :columns], sim.action, reached, sim.episode)
        return InverseModel(NetworkConfig()).fit(seen, seed)

    def _seed(self, use: int) -> np.random.SeedSequence:
        key = (*self.seed.spawn_key, use)
        return np.random.SeedSequence(self.seed.entropy, spawn_key=key)


def action_envelope(deviation_rad: float) -> ActionNoise:
    """White noise on the legs' commands: ANE's stand-in for a grounding."""
    joints = len(leg_senses(robots.get(ROBOT)).joints)
    bound = np.full(joints, LARGEST_ACTION_RAD)
    return ActionNoise(deviation_rad, -bound, bound)


def _transformer(
    forward: ForwardModel, inverse: InverseModel, noise: NoiseLaw | None
) -> ActionTransformer:
    senses = leg_senses(robots.get(ROBOT))
    bound = np.full(len(senses.joints), LARGEST_ACTION_RAD)
    columns = senses.sim_columns
    return ActionTransformer(
        forward, inverse, -bound, bound, noise, inverse_columns=columns
    )


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
    world: World = worlds.make("sim", robots.get(ROBOT), grounds, seeds)
    if sim.transformer is not None:
        senses = leg_senses(world.description)
        world = GroundedWorld(world, senses, sim.transformer, seeds)
    return walk_trials(world, np.repeat(vectors, repeats, axis=0), rules, seeds)
