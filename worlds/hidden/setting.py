"""Quantities from which the size and place of effects in concealed cases follow."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from worlds.hidden.plant import HiddenPlant

LEAST_MOTION_RAD = 0.08
"""A joint whose commands span more than this counts as one that moves [rad]. Excited
joints span ten times as much, held ones nothing: insensitive within a factor of two."""
LEAST_MOVED_M = 0.03
"""A body whose centre of mass stays in a box of smaller diagonal counts as still."""
LEAST_LEVER_M = 0.02
"""A joint feels a weight whose horizontal distance from the joint's axis gets this
large [m]."""
_LEAST_TORQUE = 0.02
"""Torque that a joint is taken to need at least, as a share of its servo's limit."""
_LEAST_SPEED_RAD_S = 0.5
"""Speed that a joint is taken to reach at least: held joints need sizes, too."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """How bodies of the nominal robot move, and what joints feel of their weight.

    Attributes:
      names: of the b bodies: each joint's link in the joints' order, then a free trunk.
      moved_m: (b,) diagonal of the box in which the centre of mass stays.
      carried_by: (b, j) whether a joint moves the body relative to the base.
      lever_m: (b, j) largest horizontal distance of the body's centre of mass from a
        joint's axis; 0 where the axis is vertical, since gravity has no lever there.
      branch_lever_m: (j,) the same for the common centre of all bodies on a joint.
      arm_m: (j, 3) from a joint's axis to its own link's centre of mass, link frame.
    """

    names: tuple[str, ...]
    moved_m: FloatArray
    carried_by: BoolArray
    lever_m: FloatArray
    branch_lever_m: FloatArray
    arm_m: FloatArray


@dataclass(frozen=True, eq=False)
class Scales:
    """Torques, speeds, reach and masses of the nominal robot in a motion.

    Sizes of hidden effects are stated as parts of these.

    Attributes:
      torque_nm: (j,) 95th percentile of each servo's torque.
      peak_nm: (j,) largest torque.
      peak_rad_s: (j,) highest speed of a command.
      reach_rad: (j, 2) lowest and highest position.
      asked_rad: (j,) span of the commands.
      inertia_kg_m2: (j,) least inertia that a torque at the joint moves.
      carried_kg: (j,) mass of all bodies that hang on a joint.
      axis: (j, 3) each joint's axis in the frame of its link.
      moving_kg: mass of all bodies that can move.
      bodies: how they move.

    Example:
      `worlds.hidden.scales.scales(plant, runs)` measures them.
    """

    torque_nm: FloatArray
    peak_nm: FloatArray
    peak_rad_s: FloatArray
    reach_rad: FloatArray
    asked_rad: FloatArray
    inertia_kg_m2: FloatArray
    carried_kg: FloatArray
    axis: FloatArray
    moving_kg: float
    bodies: Bodies

    @property
    def moving(self) -> BoolArray:
        """(j,) joints that are commanded to move."""
        return np.asarray(self.asked_rad > LEAST_MOTION_RAD)

    def moves(self, body: str) -> bool:
        """Whether a body's centre of mass moves."""
        return bool(self.bodies.moved_m[self._row(body)] >= LEAST_MOVED_M)

    def feels_weight(self, body: str) -> bool:
        """Whether some joint that moves carries the body's weight on a lever."""
        levers_m = self.bodies.lever_m[self._row(body), self.moving]
        return bool(levers_m.max(initial=0.0) >= LEAST_LEVER_M)

    def carriers(self, body: str) -> int:
        """How many of the joints that move carry the body."""
        return int(self.bodies.carried_by[self._row(body), self.moving].sum())

    def _row(self, body: str) -> int:
        return self.bodies.names.index(body)


class Spot(NamedTuple):
    """Where an effect may be: a joint's column, and that joint's link or the trunk.

    Example:
      `KINDS["backlash"].spots(plant, scales, joints)` lists the spots of a kind.
    """

    joint: int
    body: str


@dataclass(frozen=True, eq=False)
class Setting:
    """Robot, motion, spot and ease from which an effect's size follows.

    Attributes:
      plant: the robot.
      scales: of the robot's motion with nothing hidden.
      spot: where the effect is.
      ease: how easy the effect is to see, from 0 (hard) to 1 (easy); negative values
        give effects that are smaller still.
      duration_s: of each recording.
      rng: draws signs, directions and times.

    Example:
      `Hidden.sized("backlash", setting)` is an effect at the setting's spot.
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
        """Torque that the joint's servo mostly stays below, with a floor [N m]."""
        least = _LEAST_TORQUE * self.plant.max_torque_nm[self.joint]
        return float(max(self.scales.torque_nm[self.joint], least))

    @property
    def speed_rad_s(self) -> float:
        """Highest speed of the joint's command, with a floor [rad/s]."""
        return float(max(self.scales.peak_rad_s[self.joint], _LEAST_SPEED_RAD_S))

    @property
    def sign(self) -> float:
        """Plus or minus one, drawn anew at each access."""
        return float(self.rng.choice([-1.0, 1.0]))

    def part(self, easy: float, hard: float) -> float:
        """The size at this ease, interpolated evenly in the logarithm.

        Args:
          easy: size at ease 1.
          hard: size at ease 0.
        """
        return float(hard * (easy / hard) ** self.ease)

    @property
    def one_joint(self) -> bool:
        """Whether the robot has a single joint."""
        return len(self.plant.joints) == 1

    @property
    def many_joints(self) -> bool:
        """Whether several moving joints, or a free base, move the body."""
        return self.plant.floating or self.scales.carriers(self.spot.body) > 1

    @property
    def at_end(self) -> bool:
        """Whether the body is the joint's own link and the last of its chain."""
        carried = self.scales.bodies.carried_by[:, self.joint]
        own = self.spot.body == self.plant.links[self.joint]
        return own and int(carried.sum()) == 1

    @property
    def direction(self) -> FloatArray:
        """(3,) unit vector of uniform direction, drawn anew at each access."""
        way = self.rng.standard_normal(3)
        return np.asarray(way / np.linalg.norm(way))

    @property
    def across(self) -> FloatArray:
        """(3,) random unit vector across the joint's axis, in its link's frame."""
        way = np.cross(self.scales.axis[self.joint], self.direction)
        return np.asarray(way / np.linalg.norm(way))
