"""The walks of both worlds that a grounding learns from."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import robots
from experiments.grounded_walks.courses import LUMPS_M, Places, RealCourse
from experiments.grounded_walks.data import ON_COURSE, on_lumps, walk
from experiments.grounded_walks.sim import ROBOT
from groundwalk.arrays import BoolArray, FloatArray
from sgat.transitions import Transitions

EXPLORATION_RAD = (0.0, 0.01, 0.02, 0.04)
"""Noise on the commands of the sim's walks: it shows what an action does."""

REAL_EXPLORATION_RAD = (0.0, 0.03)
"""Noise on every second real walk. Commands that all change smoothly do not tell which
of them acts: without it the roll joints' latency came out at half its length."""


class RealWalks(NamedTuple):
    """Walks of the real world; see `WalkRecords`."""

    noted: Transitions
    vectors: FloatArray
    fell: BoolArray


@dataclass(frozen=True, eq=False)
class WalkRecords:
    """What was noted, and which gaits fell.

    Attributes:
      real: on the real world's lumps.
      sim: on the flat.
      uneven: of the sim on lumps of all sizes, its sensors as noisy as real's.
      vectors: (n, 16) gaits of the real walks without exploration.
      fell: (n,) whether they fell.
    """

    real: Transitions
    sim: Transitions
    uneven: Transitions
    vectors: FloatArray
    fell: BoolArray

    def joined(self, other: "WalkRecords") -> "WalkRecords":
        """These walks and then the others."""
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
    """Let gaits (n, 16) walk in the real world."""
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
    """Let gaits (n, 16) walk in the sim, twice, and put real's walks beside them."""
    robot, in_sim, on_uneven = robots.get(ROBOT), child_of(seed, 1), child_of(seed, 2)
    flat, uneven = (
        walk(place, robot, of_sim, child, EXPLORATION_RAD)[1]
        for place, child in ((places.sim(), in_sim), (places.sim(LUMPS_M), on_uneven))
    )
    return WalkRecords(real.noted, flat, uneven, real.vectors, real.fell)


def child_of(seed: np.random.SeedSequence, use: int) -> np.random.SeedSequence:
    """The random numbers of one use, the same however often they are asked for."""
    return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, use))
