"""Models of both worlds, learned from walks, and the grounded sims made from them."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

import robots
from experiments.grounded_walks.courses import LUMPS_M, START_M, Places
from experiments.grounded_walks.data import ON_COURSE
from experiments.grounded_walks.records import WalkRecords
from experiments.grounded_walks.sim import ROBOT, GroundedSim, walk_in_sim
from groundwalk.arrays import FloatArray
from sgat.models.forward_config import ForwardConfig
from sgat.noise import child_of
from sgat.transformers.action_noise import ActionNoise
from sgat.transformers.catalogue import grounding
from sgat.transformers.grounding_base import GroundingData
from sgat.walks.walk_senses import leg_senses

NONE = "no grounding"
GAT, SGAT = "GAT", "SGAT"
ENSEMBLE, UNEVEN = "SGAT, ensemble", "SGAT, uneven sim"
"""Titles of groundings in `sgat.transformers`, by which results name them."""

LARGEST_ACTION_RAD = 1.0
"""Bound of an action [rad], which is a joint command relative to the joint's position.
It is so wide that only extrapolations of a network are cut."""

LOOKED_AT = 72
"""Largest number of real walks that are repeated in the sim to find the height of its
lumps: enough to know a share of falls to about 6 % (one standard error)."""


@dataclass(frozen=True, eq=False)
class WalkModels:
    """Models of both worlds, each fitted when it is first needed.

    Attributes:
      records: walks that the models learn from.
      seed: seed of all trainings.
      places: the real world and the sim of the walks.

    Example:
      See docs/python.md, "Learn with Gymnasium".
    """

    records: WalkRecords
    seed: np.random.SeedSequence
    places: Places = field(default_factory=Places)

    @cached_property
    def data(self) -> GroundingData:
        """The walks as the data that every grounding in `sgat` learns from."""
        senses, bound = leg_senses(robots.get(ROBOT)), _bound()
        return GroundingData(
            real=self.records.real.noted,
            sim=self.records.sim,
            low=-bound,
            high=bound,
            inverse_seed=child_of(self.seed, 0),
            forward_seed=child_of(self.seed, 1),
            seed=self.seed,
            network=ForwardConfig(beta=0.5),
            uneven=self.records.uneven,
            sim_columns=senses.sim_columns,
            direct_columns=len(senses.joints),
        )

    @cached_property
    def lumps_m(self) -> float:
        """Amplitude [m] of lumps with which gaits fall as often in the sim as on real.

        The sim is grounded by `UNEVEN`; shares of falls are interpolated in `LUMPS_M`.
        """
        real = self.records.real
        vectors, fell = real.vectors[-LOOKED_AT:], real.fell[-LOOKED_AT:]
        transformer = grounding(UNEVEN).transformer
        shares = []
        for lumps_m in LUMPS_M:
            place = self.places.sim(lumps_m, START_M)
            sim = GroundedSim(transformer(self.data), place)
            seed = child_of(self.seed, 5)
            trials = walk_in_sim(sim, vectors, 1, seed, ON_COURSE, True)
            shares.append(trials.fell.mean())
        rising = np.maximum.accumulate(shares)
        return float(np.interp(fell.mean(), rising, LUMPS_M))

    def grounded(self, name: str) -> GroundedSim:
        """The sim grounded by a name or title of `sgat.transformers`, or `NONE`.

        Raises:
          UnknownNameError: there is no such grounding.
        """
        if name == NONE:
            return GroundedSim(None, self.places.sim())
        if grounding(name).uneven_sim:
            place = self.places.sim(self.lumps_m, START_M)
        else:
            place = self.places.sim()
        return GroundedSim(grounding(name).transformer(self.data), place)


def action_envelope(deviation_rad: float) -> ActionNoise:
    """Action noise envelope (ANE): white noise on the legs' commands."""
    return ActionNoise(deviation_rad, -_bound(), _bound())


def _bound() -> FloatArray:
    return np.full(len(leg_senses(robots.get(ROBOT)).joints), LARGEST_ACTION_RAD)
