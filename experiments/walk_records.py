"""The walks of both worlds that a grounding learns from."""

from dataclasses import dataclass

import numpy as np

import robots
from experiments.grounded_sim import ROBOT, any_lumps, noisy_sim
from experiments.walk_data import ON_COURSE, on_lumps, walk
from groundwalk.arrays import BoolArray, FloatArray
from sgat.transitions import Transitions

EXPLORATION_RAD = (0.0, 0.01, 0.02, 0.04)
"""Noise on the commands of the sim's walks: it shows what an action does."""

REAL_EXPLORATION_RAD = (0.0, 0.03)
"""Noise on every second real walk. Commands that all change smoothly do not tell which
of them acts: without it the roll joints' latency came out at half its length."""


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


def record_walks(
    of_real: FloatArray, of_sim: FloatArray, seed: np.random.SeedSequence
) -> WalkRecords:
    """Let some gaits (n, 16) walk in the real world, and others in the sim, twice."""
    robot = robots.get(ROBOT)
    in_real, in_sim, on_uneven = (
        np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, use))
        for use in range(3)
    )
    exploration = REAL_EXPLORATION_RAD
    trials, real = walk("real", robot, of_real, in_real, exploration, ON_COURSE)
    _, sim = walk("sim", robot, of_sim, in_sim, EXPLORATION_RAD)
    _, uneven = walk(
        "sim",
        robot,
        of_sim,
        on_uneven,
        EXPLORATION_RAD,
        ground=any_lumps,
        options=noisy_sim(),
    )
    as_it_is = slice(None, None, len(exploration))
    return WalkRecords(
        on_lumps(real), sim, uneven, of_real[as_it_is], trials.fell[as_it_is]
    )
