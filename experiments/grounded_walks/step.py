"""The grounding steps that a search may walk in."""

from dataclasses import replace
from functools import cached_property

import numpy as np

from experiments.grounded_walks.courses import SHORT_START_M, Places
from experiments.grounded_walks.data import ON_COURSE, GaitCloud
from experiments.grounded_walks.methods import GROUNDINGS, UNEVEN, WalkModels
from experiments.grounded_walks.raters import RATED, GroundedRater
from experiments.grounded_walks.records import (
    RealWalks,
    WalkRecords,
    child_of,
    record_real,
    record_walks,
)
from walk_engine import Gait

LUMPS_MARGIN = 1.2
"""A search's lumps are higher than real's by this. Gaits tuned on lumps as high as
those lie where falls begin, and fell on 10 and 15 of 40 real courses."""


class Grounding:
    """The data of one grounding step and the models learned from them, when asked."""

    def __init__(
        self,
        around: Gait,
        cloud: GaitCloud,
        walks: tuple[int, int],
        seed: np.random.SeedSequence,
        before: "Grounding | None" = None,
        places: Places | None = None,
        beside: "Grounding | None" = None,
    ) -> None:
        """Say what shall be walked.

        Args:
          around: the gait that the data are about.
          cloud: of the gaits that walk.
          walks: in the real world and in the sim.
          seed: of gaits, walks and trainings.
          before: the step before, whose data count as well.
          places: the two worlds; the plain ones where None.
          beside: a step from the same gait and seed, whose real walks are these, too.
        """
        self._around, self._cloud, self._walks = around, cloud, walks
        self._seeds = [child_of(seed, use) for use in range(4)]
        self._before, self._beside = before, beside
        self._places = places or Places()

    @cached_property
    def real(self) -> RealWalks:
        """This step's walks of the real world."""
        if self._beside is not None:
            return self._beside.real
        vectors = self._cloud.draw(self._around, self._walks[0], self._seeds[0])
        return record_real(vectors, self._seeds[2], self._places.real)

    @cached_property
    def records(self) -> WalkRecords:
        """All walks so far."""
        of_sim = self._cloud.draw(self._around, self._walks[1], self._seeds[1])
        new = record_walks(self.real, of_sim, self._seeds[2], self._places)
        return new if self._before is None else self._before.records.joined(new)

    @cached_property
    def models(self) -> WalkModels:
        """Fitted to all data so far."""
        return WalkModels(self.records, self._seeds[3], self._places)

    def rater(self, grounding: str, repeats: int) -> GroundedRater:
        """The sim behind one of `GROUNDINGS`."""
        assert grounding in GROUNDINGS
        sim = self.models.grounded(grounding)
        if grounding == UNEVEN:
            lumps_m = LUMPS_MARGIN * self.models.lumps_m
            sim = replace(sim, place=self._places.sim(lumps_m, SHORT_START_M))
        # Where lumps make a robot fall, a walk tells the more the longer it is.
        rules = ON_COURSE if grounding == UNEVEN else RATED
        return GroundedRater(sim, repeats, rules)


def cloud_around(gait: Gait) -> GaitCloud:
    """Gaits near a tuned one, from half to a little above its speed."""
    fastest_m_s = gait["max_forward"]
    return GaitCloud(0.06, 0.5 * fastest_m_s, min(1.1 * fastest_m_s, 0.45))
