"""A grounding step: models of both worlds, learned from walks, and grounded sims."""

from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

import robots
from experiments.grounded_walks.courses import LUMPS_M, SHORT_START_M, START_M, Places
from experiments.grounded_walks.walks import (
    ON_COURSE,
    ROBOT,
    WALK,
    GroundedSim,
    RealWalks,
    WalkRecords,
    rate_in_sim,
    record_real,
    record_walks,
    walk_in_sim,
)
from experiments.walking.search import Rater
from groundwalk.arrays import FloatArray
from sgat.models.config import ForwardConfig
from sgat.noise import ActionNoise, child_of
from sgat.transformers.catalogue import grounding
from sgat.transformers.grounding_base import GroundingData
from sgat.walks.gait_cloud import GaitCloud
from sgat.walks.walk_senses import leg_senses
from walk_engine import Gait

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
      >>> models = GroundingStep(gait, GaitCloud(), (96, 200), seed).models
      >>> models.grounded("sgat").transformer
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


LUMPS_MARGIN = 1.2
"""Ratio of the lumps' height in a search to the height at which the sim has as many
falls as the real world. Gaits tuned at a ratio of 1 are at the edge of falling: two of
them fell on 10 and on 15 of 40 real courses."""


class GroundingStep:
    """A grounding step: its walks and models, computed when first asked for.

    Example:
      See docs/python.md, "Learn with Gymnasium".
    """

    def __init__(
        self,
        around: Gait,
        cloud: GaitCloud,
        walks: tuple[int, int],
        seed: np.random.SeedSequence,
        before: "GroundingStep | None" = None,
        places: Places | None = None,
        beside: "GroundingStep | None" = None,
    ) -> None:
        """Describe the step; no robot walks yet.

        Args:
          around: gait around which the gaits that walk are drawn.
          cloud: draws the gaits that walk.
          walks: numbers of walks in the real world and in the sim.
          seed: seed of gaits, walks and trainings.
          before: the previous step, whose walks are used as well.
          places: the two worlds; by default the real world's own terrain, and the sim
            without a diagnosis.
          beside: a step with the same gait and seed, whose real walks are used.
        """
        self._around, self._cloud, self._walks = around, cloud, walks
        self._seeds = [child_of(seed, use) for use in range(4)]
        self._before, self._beside = before, beside
        self._places = places or Places()

    @cached_property
    def real(self) -> RealWalks:
        """Walks in the real world that this grounding step adds."""
        if self._beside is not None:
            return self._beside.real
        vectors = self._cloud.draw(self._around, self._walks[0], self._seeds[0])
        return record_real(vectors, self._seeds[2], self._places.real)

    @cached_property
    def records(self) -> WalkRecords:
        """The walks of this step and of all steps before it."""
        of_sim = self._cloud.draw(self._around, self._walks[1], self._seeds[1])
        new = record_walks(self.real, of_sim, self._seeds[2], self._places)
        return new if self._before is None else self._before.records.joined(new)

    @cached_property
    def models(self) -> WalkModels:
        """Models of both worlds, learned from `records`."""
        return WalkModels(self.records, self._seeds[3], self._places)

    def rater(self, name: str, repeats: int) -> Rater:
        """A rater of gaits in the grounded sim, with several walks of each gait.

        The grounding has a name or title of `sgat.transformers`; an unknown one is
        refused (UnknownNameError) before any walk.
        """
        uneven = grounding(name).uneven_sim
        sim = self.models.grounded(name)
        if uneven:
            lumps_m = LUMPS_MARGIN * self.models.lumps_m
            sim = replace(sim, place=self._places.sim(lumps_m, SHORT_START_M))
        # On lumps, a longer walk shows more of the falls.
        return partial(rate_in_sim, sim, repeats, ON_COURSE if uneven else WALK)
