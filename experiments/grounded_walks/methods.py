"""The groundings of the walking robot that are compared."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

import robots
from experiments.grounded_walks.courses import LUMPS_M, START_M, Places
from experiments.grounded_walks.data import ON_COURSE, leg_senses
from experiments.grounded_walks.records import WalkRecords
from experiments.grounded_walks.sim import ROBOT, GroundedSim, walk_in_sim
from groundwalk.arrays import FloatArray
from sgat.models.forward_config import ForwardConfig
from sgat.models.forward_model import ForwardModel
from sgat.models.inverse_model import InverseModel
from sgat.models.network_config import NetworkConfig
from sgat.noise import NoiseLaw, WhiteNoise
from sgat.transformers.action_noise import ActionNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transformers.block_noise import BlockNoise
from sgat.transformers.direct_transformer import DirectTransformer
from sgat.walks.walk_senses import WalkSenses

NONE, GAT, SGAT = "no grounding", "GAT", "SGAT"
ENSEMBLE, UNEVEN = "SGAT, ensemble", "SGAT, uneven sim"
GROUNDINGS = (NONE, GAT, SGAT, ENSEMBLE, UNEVEN)

BLOCK_TICKS = 50
"""Two to three steps: a bump pushes all joints one way for several ticks."""

MEMBERS = 4
"""Networks of the ensemble: a search cannot live on the errors of a single one."""

LARGEST_ACTION_RAD = 1.0

LOOKED_AT = 72
"""Real walks that are walked again in the sim to find the amplitude."""


@dataclass(frozen=True, eq=False)
class WalkModels:
    """Models of both worlds, each fitted when it is first needed.

    Attributes:
      records: what they learn from.
      seed: of the trainings.
      places: where the walks were walked.
    """

    records: WalkRecords
    seed: np.random.SeedSequence
    places: Places = field(default_factory=Places)

    @cached_property
    def inverse(self) -> InverseModel:
        """Of the sim; it sees the first columns of a state, without commands."""
        columns, sim = _senses().sim_columns, self.records.sim
        seen = replace(sim, state=sim.state[:, :columns])
        return InverseModel(NetworkConfig()).fit(seen, self._seed(0))

    @cached_property
    def direct(self) -> DirectTransformer:
        """Of the uneven sim, for the joints alone: its own lumps move the torso."""
        senses, bound = _senses(), _bound()
        joints = len(senses.joints)
        real, tried = (
            replace(walks, next_state=walks.next_state[:, :joints])
            for walks in (self.records.real, self.records.uneven)
        )
        tried = replace(tried, state=tried.state[:, : senses.sim_columns])
        sim = ForwardModel(ForwardConfig(beta=1.0)).fit(tried, self._seed(3))
        return DirectTransformer(-bound, bound).fit(real, sim, tried, self._seed(4))

    @cached_property
    def lumps_m(self) -> float:
        """Amplitude at which the gaits of the real walks fall as often in the sim."""
        vectors = self.records.vectors[-LOOKED_AT:]
        fell = self.records.fell[-LOOKED_AT:]
        shares = []
        for lumps_m in LUMPS_M:
            sim = GroundedSim(self.direct, self.places.sim(lumps_m, START_M))
            trials = walk_in_sim(sim, vectors, 1, self._seed(5), ON_COURSE, True)
            shares.append(trials.fell.mean())
        rising = np.maximum.accumulate(shares)
        return float(np.interp(fell.mean(), rising, LUMPS_M))

    @cached_property
    def forward(self) -> ForwardModel:
        """Of the real world."""
        return ForwardModel(ForwardConfig(beta=0.5)).fit(
            self.records.real, self._seed(1)
        )

    @cached_property
    def ensemble(self) -> ForwardModel:
        """Of the real world; a robot keeps one member for a walk."""
        config = ForwardConfig(beta=0.5, members=MEMBERS)
        return ForwardModel(config).fit(self.records.real, self._seed(2))

    def grounded(self, name: str) -> GroundedSim:
        """The sim of one of `GROUNDINGS`.

        The ensemble's noise are blocks of the real walks' residuals: with their memory,
        their tails, and what they have in common across joints and torso. The uneven
        sim has lumps of its own: commands on flat ground cannot make a robot trip.
        """
        if name == NONE:
            return GroundedSim(None, self.places.sim())
        if name == UNEVEN:
            return GroundedSim(self.direct, self.places.sim(self.lumps_m, START_M))
        noise: NoiseLaw | None = None
        forward = self.ensemble if name == ENSEMBLE else self.forward
        if name == ENSEMBLE:
            real = self.records.real
            noise = BlockNoise(forward.residuals(real), real.episode, BLOCK_TICKS)
        elif name == SGAT:
            noise = WhiteNoise(forward.outcomes)
        transformer = _transformer(forward, self.inverse, noise)
        return GroundedSim(transformer, self.places.sim())

    def _seed(self, use: int) -> np.random.SeedSequence:
        key = (*self.seed.spawn_key, use)
        return np.random.SeedSequence(self.seed.entropy, spawn_key=key)


def action_envelope(deviation_rad: float) -> ActionNoise:
    """White noise on the legs' commands: ANE's stand-in for a grounding."""
    bound = _bound()
    return ActionNoise(deviation_rad, -bound, bound)


def _transformer(
    forward: ForwardModel, inverse: InverseModel, noise: NoiseLaw | None
) -> ActionTransformer:
    bound, columns = _bound(), _senses().sim_columns
    return ActionTransformer(
        forward, inverse, -bound, bound, noise, inverse_columns=columns
    )


def _senses() -> WalkSenses:
    return leg_senses(robots.get(ROBOT))


def _bound() -> FloatArray:
    return np.full(len(_senses().joints), LARGEST_ACTION_RAD)
