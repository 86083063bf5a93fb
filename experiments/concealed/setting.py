"""What the size of a concealed effect depends on."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from experiments.concealed.where import Spot, moved_by_many
from groundwalk.arrays import FloatArray
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.scales import Scales


class Span(NamedTuple):
    """A size where it is easy to see, and where it is hard."""

    easy: float
    hard: float

    def at(self, ease: float) -> float:
        """The size at an ease, 0 (hard) to 1 or below, even in its logarithm."""
        return float(self.hard * (self.easy / self.hard) ** ease)


@dataclass(frozen=True, eq=False)
class Setting:
    """What an effect's size depends on.

    Attributes:
      plant: the robot.
      scales: what it does with nothing hidden.
      spot: where.
      ease: from 0, hard, to 1, easy; below 0 harder still.
      duration_s: of the recordings.
      rng: draws signs, directions and times.
    """

    plant: HiddenPlant
    scales: Scales
    spot: Spot
    ease: float
    duration_s: float
    rng: np.random.Generator

    @property
    def joint(self) -> int:
        """Column of the joint."""
        return self.spot.joint

    @property
    def torque_nm(self) -> float:
        """Of the joint's servo, mostly; at least a fiftieth of what it can."""
        least = 0.02 * self.plant.max_torque_nm[self.joint]
        return float(max(self.scales.torque_nm[self.joint], least))

    @property
    def speed_rad_s(self) -> float:
        """Of the joint's command, at most; something if it is held."""
        return float(max(self.scales.peak_rad_s[self.joint], 0.5))

    @property
    def sign(self) -> float:
        """Plus or minus one."""
        return float(self.rng.choice([-1.0, 1.0]))

    def part(self, easy: float, hard: float) -> float:
        """A size between these."""
        return Span(easy, hard).at(self.ease)

    @property
    def one_joint(self) -> bool:
        """Whether the robot has no other."""
        return len(self.plant.joints) == 1

    @property
    def many_joints(self) -> bool:
        """Whether several joints, or a free base, move the body."""
        return moved_by_many(self.plant, self.scales, self.spot.body)

    @property
    def at_end(self) -> bool:
        """Whether nothing hangs on the body, which is the joint's link."""
        carried = self.scales.bodies.carried_by[:, self.joint]
        own = self.spot.body == self.plant.links[self.joint]
        return own and int(carried.sum()) == 1

    @property
    def direction(self) -> FloatArray:
        """(3,) of length one."""
        way = self.rng.standard_normal(3)
        return np.asarray(way / np.linalg.norm(way))

    @property
    def across(self) -> FloatArray:
        """(3,) of length one, across the joint's axis in its link's frame."""
        way = np.cross(self.scales.axis[self.joint], self.direction)
        return np.asarray(way / np.linalg.norm(way))
