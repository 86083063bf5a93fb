"""The walks of both worlds that a grounding learns from."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import robots
from experiments.grounded_walks.courses import LUMPS_M, Places, RealCourse
from experiments.grounded_walks.data import ON_COURSE, on_lumps, walk
from experiments.grounded_walks.sim import ROBOT
from groundwalk.arrays import BoolArray, FloatArray
from sgat.noise import child_of
from sgat.transitions import Transitions

EXPLORATION_RAD = (0.0, 0.01, 0.02, 0.04)
"""Standard deviations [rad] of the noise on commands in the sim; the walks get them in
turn. Without noise, data do not show the effect of a single action."""

REAL_EXPLORATION_RAD = (0.0, 0.03)
"""Standard deviations [rad] of the noise on commands in the real world: every second
walk has noise. Gaits change commands smoothly: from walks without noise, models learned
half of the true latency of the roll joints."""


class RealWalks(NamedTuple):
    """Walks of the real world.

    Attributes:
      noted: transitions, without those on the flat ground around the start.
      vectors: (n, 16) gaits that walked without noise on their commands.
      fell: (n,) whether each of these fell.
    """

    noted: Transitions
    vectors: FloatArray
    fell: BoolArray


@dataclass(frozen=True, eq=False)
class WalkRecords:
    """Walks of both worlds.

    Attributes:
      real: transitions of the real world, without the flat ground around the start.
      sim: transitions of the flat sim.
      uneven: transitions of the sim on lumps of all sizes, with sensors as noisy as the
        real world's.
      vectors: (n, 16) gaits of the real walks without noise on commands.
      fell: (n,) whether each of these fell.
    """

    real: Transitions
    sim: Transitions
    uneven: Transitions
    vectors: FloatArray
    fell: BoolArray

    def joined(self, other: "WalkRecords") -> "WalkRecords":
        """These walks, followed by those of another step."""
        return WalkRecords(
            self.real.joined(other.real),
            self.sim.joined(other.sim),
            self.uneven.joined(other.uneven),
            np.vstack([self.vectors, other.vectors]),
            np.concatenate([self.fell, other.fell]),
        )


def record_real(
    vectors: FloatArray, seed: np.random.SeedSequence, course: RealCourse
) -> RealWalks:
    """Let gaits (n, 16) walk in the real world, with all randomness from the seed."""
    exploration, robot = REAL_EXPLORATION_RAD, robots.get(ROBOT)
    trials, real = walk(
        course, robot, vectors, child_of(seed, 0), exploration, ON_COURSE
    )
    as_it_is = slice(None, None, len(exploration))
    return RealWalks(on_lumps(real), vectors[as_it_is], trials.fell[as_it_is])


def record_walks(
    real: RealWalks,
    of_sim: FloatArray,
    seed: np.random.SeedSequence,
    places: Places,
) -> WalkRecords:
    """Let gaits (n, 16) walk in the flat and the uneven sim, and add the real walks."""
    robot, in_sim, on_uneven = robots.get(ROBOT), child_of(seed, 1), child_of(seed, 2)
    flat, uneven = (
        walk(place, robot, of_sim, child, EXPLORATION_RAD)[1]
        for place, child in ((places.sim(), in_sim), (places.sim(LUMPS_M), on_uneven))
    )
    return WalkRecords(real.noted, flat, uneven, real.vectors, real.fell)
