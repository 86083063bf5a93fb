"""The walks of both worlds that a grounding learns from."""

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


class WalkRecords(NamedTuple):
    """Walks of the real world, and transitions of the flat and of the uneven sim.

    The uneven sim has lumps of all sizes, and sensors as noisy as the real world's.
    """

    real: RealWalks
    sim: Transitions
    uneven: Transitions

    def joined(self, other: "WalkRecords") -> "WalkRecords":
        """These walks, followed by those of another step."""
        real, more = self.real, other.real
        return WalkRecords(
            RealWalks(
                real.noted.joined(more.noted),
                np.vstack([real.vectors, more.vectors]),
                np.concatenate([real.fell, more.fell]),
            ),
            self.sim.joined(other.sim),
            self.uneven.joined(other.uneven),
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
    _, flat = walk(places.sim(), robot, of_sim, in_sim, EXPLORATION_RAD)
    _, uneven = walk(places.sim(LUMPS_M), robot, of_sim, on_uneven, EXPLORATION_RAD)
    return WalkRecords(real, flat, uneven)
