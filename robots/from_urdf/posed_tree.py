"""A URDF with most joints held in a pose: which links move together, and where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError
from robots.from_urdf.placement import Placement
from robots.from_urdf.urdf_tree import UrdfLink, UrdfTree
from robots.rigid_body import Inertial, combined

_NOISE = 12


@dataclass(frozen=True, eq=False)
class PosedTree:
    """A robot whose frames are all seen from its root: x forward, y left, z up.

    Attributes:
      tree: the URDF.
      turn: (3, 3) from the root link's frame to those axes.
      moving: joints that move, parents first.
      pose_rad: angles of joints; zero where they are not named, as all that move.
    """

    tree: UrdfTree
    turn: FloatArray
    moving: tuple[str, ...]
    pose_rad: Mapping[str, float]

    @cached_property
    def placed(self) -> dict[str, Placement]:
        """Where every link is."""
        turned = Placement(self.turn, np.zeros(3))
        placed = self.tree.placements(self.pose_rad)
        return {name: turned @ placement for name, placement in placed.items()}

    @cached_property
    def carriers(self) -> dict[str, str]:
        """The moving joint that each link moves with, "" for the root."""
        carriers = {self.tree.root: ""}
        for joint in self.tree.joints.values():
            above = carriers[joint.parent]
            carriers[joint.child] = joint.name if joint.name in self.moving else above
        return carriers

    def in_pose(self, angles_rad: Mapping[str, float]) -> "PosedTree":
        """This robot with further joints held at the given angles."""
        return replace(self, pose_rad={**self.pose_rad, **angles_rad})

    def carried(self, joint: str) -> list[UrdfLink]:
        """The links that move with a joint, "" for the root."""
        links = self.tree.links
        return [links[name] for name, by in self.carriers.items() if by == joint]

    def parent(self, joint: str) -> str:
        """The moving joint above a joint, "" for the root."""
        return self.carriers[self.tree.joints[joint].parent]

    def origin_m(self, joint: str) -> FloatArray:
        """(3,) where a joint is, (0, 0, 0) for the root."""
        if not joint:
            return np.zeros(3)
        return self.placed[self.tree.joints[joint].child].position_m

    def axis(self, joint: str) -> FloatArray:
        """(3,) a joint's axis, without the last digits that turning frames leaves."""
        urdf = self.tree.joints[joint]
        axis = np.round(self.placed[urdf.child].rotation @ urdf.axis, _NOISE)
        return np.asarray(axis / np.linalg.norm(axis) + 0.0)  # no negative zeros

    def offset_m(self, joint: str) -> FloatArray:
        """(3,) from the joint above to a joint."""
        offset = self.origin_m(joint) - self.origin_m(self.parent(joint))
        return np.asarray(np.round(offset, _NOISE) + 0.0)

    def inertial(self, joint: str) -> Inertial:
        """The links that move with a joint, without joints below, as one body.

        Raises:
          BadModelError: it has no mass.
        """
        bodies = self._bodies([joint])
        if not bodies:
            raise BadModelError(
                f"{self.tree.path}: nothing that {joint or 'the root'} moves has a mass"
            )
        return combined(bodies).moved(-self.origin_m(joint))

    def below(self, joint: str) -> list[str]:
        """A joint and the moving joints that hang on it; all for the root."""
        return [
            name
            for name in ("", *self.moving)
            if not joint
            or (name and joint in self.tree.chain(self.tree.joints[name].child))
        ]

    def hanging(self, joint: str) -> Inertial:
        """Everything that a joint carries, joints below included, as one body."""
        return combined(self._bodies(self.below(joint)))

    def _bodies(self, joints: Sequence[str]) -> list[Inertial]:
        """The bodies that move with some joints, in the root's frame."""
        bodies = []
        for link in (link for joint in joints for link in self.carried(joint)):
            if link.inertial is not None:
                at, own = self.placed[link.name], link.inertial
                inertia = at.rotation @ own.inertia_kg_m2 @ at.rotation.T
                bodies.append(Inertial(own.mass_kg, at.points(own.com_m), inertia))
        return bodies
