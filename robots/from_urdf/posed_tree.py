"""A URDF with most joints fixed in a pose: which links move together, and where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError
from robots.from_urdf.urdf_tree import Placement, UrdfLink, UrdfTree
from robots.rigid_body import Inertial, combined

_NOISE = 12


@dataclass(frozen=True, eq=False)
class PosedTree:
    """A URDF's robot in one pose, in a frame at its root: x forward, y left, z up.

    Where a joint's name is asked for, "" stands for the root; "the root frame" is the
    frame above, to which `turn` (3, 3) leads from the URDF's root link. The joints in
    `moving`, parents first, move; others are fixed at their angle in `pose_rad`, or at
    zero.
    """

    tree: UrdfTree
    turn: FloatArray
    moving: tuple[str, ...]
    pose_rad: Mapping[str, float]

    @cached_property
    def placed(self) -> dict[str, Placement]:
        """Placement of every link in the root frame (x forward, y left, z up)."""
        turned = Placement(self.turn, np.zeros(3))
        placed = self.tree.placements(self.pose_rad)
        return {name: turned @ placement for name, placement in placed.items()}

    @cached_property
    def carriers(self) -> dict[str, str]:
        """By link: name of the moving joint with which it moves, "" for the root."""
        carriers = {self.tree.root: ""}
        for joint in self.tree.joints.values():
            above = carriers[joint.parent]
            carriers[joint.child] = joint.name if joint.name in self.moving else above
        return carriers

    def in_pose(self, angles_rad: Mapping[str, float]) -> "PosedTree":
        """Copy of this robot with further joints at the given angles [rad]."""
        return replace(self, pose_rad={**self.pose_rad, **angles_rad})

    def carried(self, joint: str) -> list[UrdfLink]:
        """Links that move rigidly with a moving joint, or with the root for ""."""
        links = self.tree.links
        return [links[name] for name, by in self.carriers.items() if by == joint]

    def parent(self, joint: str) -> str:
        """Name of the next moving joint above a joint, "" if that is the root."""
        return self.carriers[self.tree.joints[joint].parent]

    def origin_m(self, joint: str) -> FloatArray:
        """(3,) position of a joint in the root frame [m], zeros for the root ""."""
        if not joint:
            return np.zeros(3)
        return self.placed[self.tree.joints[joint].child].position_m

    def axis(self, joint: str) -> FloatArray:
        """(3,) unit vector of a joint's axis in the root frame, with 12 decimals."""
        urdf = self.tree.joints[joint]
        axis = np.round(self.placed[urdf.child].rotation @ urdf.axis, _NOISE)
        return np.asarray(axis / np.linalg.norm(axis) + 0.0)  # no negative zeros

    def offset_m(self, joint: str) -> FloatArray:
        """(3,) vector from the next moving joint above (or root) to a joint [m]."""
        offset = self.origin_m(joint) - self.origin_m(self.parent(joint))
        return np.asarray(np.round(offset, _NOISE) + 0.0)

    def inertial(self, joint: str) -> Inertial:
        """Inertial of all links that move rigidly with a joint, in the joint's frame.

        Links below the next moving joint do not count; "" stands for the root.
        """
        bodies = self._bodies([joint])
        if not bodies:
            raise BadModelError(
                f"{self.tree.path}: nothing that {joint or 'the root'} moves has a mass"
            )
        return combined(bodies).moved(-self.origin_m(joint))

    def below(self, joint: str) -> list[str]:
        """Names of a joint and all moving joints below it; all for the root ""."""
        return [
            name
            for name in ("", *self.moving)
            if not joint
            or (name and joint in self.tree.chain(self.tree.joints[name].child))
        ]

    def hanging(self, joint: str) -> Inertial:
        """Inertial, in the root frame, of all links below a joint (for "" of all)."""
        return combined(self._bodies(self.below(joint)))

    def _bodies(self, joints: Sequence[str]) -> list[Inertial]:
        """Inertials, in the root frame, of the links that move with some joints."""
        bodies = []
        for link in (link for joint in joints for link in self.carried(joint)):
            if link.inertial is not None:
                at, own = self.placed[link.name], link.inertial
                inertia = at.rotation @ own.inertia_kg_m2 @ at.rotation.T
                bodies.append(Inertial(own.mass_kg, at.points(own.com_m), inertia))
        return bodies
