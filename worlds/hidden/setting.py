"""Quantities that decide size and place of the hidden effect drawn for a test case."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import BoolArray, FloatArray
from worlds.hidden.plant import HiddenPlant

_LEAST_MOTION_RAD = 0.08
"""Range of a joint's commands [rad] above which the joint counts as moving. Excited
joints have ten times as much, held ones none: insensitive within a factor of two."""
_LEAST_MOVED_M = 0.03
"""A body whose centre of mass stays in a box of this diagonal [m] counts as still."""
LEAST_LEVER_M = 0.02
"""Lever arm [m] of gravity about a joint that a body must reach at some time, so that
its weight counts as noticeable at that joint."""
_LEAST_TORQUE = 0.02
"""Floor of a joint's usual torque, as a share of its servo's limit, so that effects at
idle joints have a size above 0, too."""
_LEAST_SPEED_RAD_S = 0.5
"""Floor of a command's top speed, so that effects at held joints have a size, too."""


@dataclass(frozen=True, eq=False)
class Scales:
    """Torques, ranges and masses of the nominal robot's j joints and b bodies.

    `worlds.hidden.scales.scales` measures them in a motion. Sizes of hidden effects are
    drawn as shares of them.

    Attributes:
      torque_nm, peak_nm: (j,) absolute torque of each servo: 95th percentile, largest.
      peak_rad_s, asked_rad: (j,) highest speed and range of the commands.
      reach_rad: (j, 2) lowest and highest position.
      inertia_kg_m2: (j,) inertia seen by a torque at the joint, all others free.
      carried_kg: (j,) mass of all bodies beyond a joint.
      axis: (j, 3) each joint's axis in the frame of its link.
      moving_kg: mass of all bodies that can move.
      bodies: link of each joint in their order, then the trunk if it is free.
      moved_m: (b,) diagonal of the smallest box that holds the centre of mass.
      carried_by: (b, j) whether a joint moves the body relative to the base.
      lever_m: (b, j) largest lever arm of the body's weight about a joint's axis.
      branch_lever_m: (j,) the same for the weight of all bodies beyond a joint.
      arm_m: (j, 3) from a joint's axis to its link's centre of mass, link frame.

    Example:
      >>> measured = scales(plant, [run])  # of `worlds.hidden.scales`
      >>> measured.torque_nm, measured.moves("forearm")
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
    bodies: tuple[str, ...]
    moved_m: FloatArray
    carried_by: BoolArray
    lever_m: FloatArray
    branch_lever_m: FloatArray
    arm_m: FloatArray

    @property
    def moving(self) -> BoolArray:
        """(j,) flags of the joints that are commanded to move."""
        return np.asarray(self.asked_rad > _LEAST_MOTION_RAD)

    def moves(self, body: str) -> bool:
        """Whether a body's centre of mass moves noticeably, by at least 3 cm."""
        return bool(self.moved_m[self._row(body)] >= _LEAST_MOVED_M)

    def feels_weight(self, body: str) -> bool:
        """Whether the body's weight noticeably loads a joint that moves."""
        levers_m = self.lever_m[self._row(body), self.moving]
        return bool(levers_m.max(initial=0.0) >= LEAST_LEVER_M)

    def carriers(self, body: str) -> int:
        """Number of joints that are commanded to move and move this body."""
        return int(self.carried_by[self._row(body), self.moving].sum())

    def _row(self, body: str) -> int:
        return self.bodies.index(body)


class Spot(NamedTuple):
    """Where an effect may be: index of a joint, and the name of its link or the trunk.

    An effect on a joint uses the first, an effect on a body the second.

    Example:
      >>> Spot(0, "forearm").body
      'forearm'
    """

    joint: int
    body: str


@dataclass(frozen=True, eq=False)
class Setting:
    """All that decides the size of a hidden effect drawn for a test case.

    From the nominal robot, the scales of its motion without effects, the spot of the
    effect and the length of each recording. `ease` says how easy the effect is to
    detect, from 0 (hard) to 1 (easy), or below 0; `rng` draws signs, directions and
    times.

    Example:
      >>> Setting(plant, scales, Spot(0, "link"), 0.5, 8.0, rng).torque_nm
    """

    plant: HiddenPlant
    scales: Scales
    spot: Spot
    ease: float
    duration_s: float
    rng: np.random.Generator

    @property
    def joint(self) -> int:
        """Index of the joint where the effect is."""
        return self.spot.joint

    @property
    def torque_nm(self) -> float:
        """Usual torque of the joint's servo [N m], at least 2 % of its largest."""
        least = _LEAST_TORQUE * self.plant.max_torque_nm[self.joint]
        return float(max(self.scales.torque_nm[self.joint], least))

    @property
    def speed_rad_s(self) -> float:
        """Highest speed of the joint's command [rad/s], at least 0.5."""
        return float(max(self.scales.peak_rad_s[self.joint], _LEAST_SPEED_RAD_S))

    @property
    def sign(self) -> float:
        """1 or -1, drawn at random on each access."""
        return float(self.rng.choice([-1.0, 1.0]))

    def part(self, easy: float, hard: float) -> float:
        """Size between `hard` (ease 0) and `easy` (ease 1), on a logarithmic scale."""
        return float(hard * (easy / hard) ** self.ease)

    @property
    def many_joints(self) -> bool:
        """Whether several moving joints, or a free base, move the spot's body."""
        return self.plant.floating or self.scales.carriers(self.spot.body) > 1

    @property
    def at_end(self) -> bool:
        """Whether the body is moved by the joint of this place and carries no other."""
        carried = self.scales.carried_by[:, self.joint]
        own = self.spot.body == self.plant.links[self.joint]
        return own and int(carried.sum()) == 1

    @property
    def direction(self) -> FloatArray:
        """(3,) unit vector of uniformly random direction, drawn on each access."""
        way = self.rng.standard_normal(3)
        return np.asarray(way / np.linalg.norm(way))

    @property
    def across(self) -> FloatArray:
        """(3,) random unit vector normal to the joint's axis, in its link's frame."""
        way = np.cross(self.scales.axis[self.joint], self.direction)
        return np.asarray(way / np.linalg.norm(way))
