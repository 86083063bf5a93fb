"""A grounding step: walks in both worlds, models learned from them, a grounded sim."""

from dataclasses import replace
from functools import cached_property, partial

import numpy as np

from experiments.grounded_walks.courses import SHORT_START_M, Places
from experiments.grounded_walks.data import ON_COURSE, WALK
from experiments.grounded_walks.models import WalkModels
from experiments.grounded_walks.raters import rate_in_sim
from experiments.grounded_walks.records import (
    RealWalks,
    WalkRecords,
    record_real,
    record_walks,
)
from experiments.walking.tuning import Rater
from sgat.noise import child_of
from sgat.transformers.catalogue import grounding
from sgat.walks.gait_cloud import GaitCloud
from walk_engine import Gait

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
        """This step's walks in the real world."""
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
