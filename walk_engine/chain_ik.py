"""Joint angles of legs whose axes need not meet, by damped Gauss-Newton steps.

Let p and R be where the leg's angles q put its last joint, p* and R* where they shall.
With the joints' axes a_k and places p_k, the Jacobian's columns are
(a_k x (p - p_k), a_k). The error is e = (p* - p, 1/2 sum_i R e_i x R* e_i), its second
half the turn from R to R* to second order, and a step is

    q <- q + J^T (J J^T + d^2 E)^-1 e,

lengths in units of the leg's. The damping d and a longest step keep angles finite
where the leg is straight or the target out of reach. The start is the closed form of
the leg most like it, so that few steps are enough: as many for every robot, so that
none depends on what its neighbours do.
"""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import LEG_JOINTS, LegChain

STEPS = 5
DAMPING = 0.003
LONGEST_RAD = 0.5
"""By which a step may change an angle."""


class ChainLegs:
    """A left and a right leg, each with its own joints."""

    def __init__(self, chains: tuple[LegChain, LegChain], length_m: float) -> None:
        """Prepare.

        Args:
          chains: the left leg and the right one.
          length_m: of a leg; the unit of lengths in what a step weighs.
        """
        # Second axis: the two legs, one for each of the first axis' joints.
        self._origins = np.stack([chain.origins_m for chain in chains], axis=1)
        self._axes = np.stack([chain.axes for chain in chains], axis=1)
        self._chains = chains
        self._length_m = length_m
        self._skew = np.array([[_skew(axis) for axis in pair] for pair in self._axes])

    def angles(
        self, by_role_rad: FloatArray, ankle_m: FloatArray, foot: FloatArray
    ) -> FloatArray:
        """Angles by role that put both feet where they shall be.

        Args:
          by_role_rad: (6, 2, n) angles to start from, as of the leg most like it.
          ankle_m: (2, n, 3) where the ankles shall be, in the torso's frame.
          foot: (2, n, 3, 3) rotations from the feet's frames to the torso's.

        Returns:
          (6, 2, n) of yaw, roll, pitch, knee, ankle pitch and ankle roll, as the
          robot's joints count them.
        """
        start = np.stack(
            [
                self._in_chain(chain, by_role_rad[:, side])
                for side, chain in enumerate(self._chains)
            ],
            axis=1,
        )
        shift = np.stack([chain.foot_m for chain in self._chains])
        target = ankle_m + (foot @ shift[:, None, :, None])[..., 0]
        q = start
        for _ in range(STEPS):
            q = q + self._step(q, target, foot)
        return np.stack(
            [q[chain.order, side] for side, chain in enumerate(self._chains)], axis=1
        )

    def error(
        self, q: FloatArray, target_m: FloatArray, foot: FloatArray
    ) -> FloatArray:
        """(2, n, 6) what is missing to a pose: lengths in leg lengths, then turns."""
        places, rotations, _ = self._forward(q)
        return self._error(places[-1], rotations, target_m, foot)

    def _in_chain(self, chain: LegChain, by_role_rad: FloatArray) -> FloatArray:
        """(6, n) the joints' own angles in the chain's order."""
        own = chain.signs[:, None] * (by_role_rad - chain.zero_rad[:, None])
        angles = np.empty_like(own)
        angles[chain.order] = own
        return angles

    def _step(
        self, q: FloatArray, target_m: FloatArray, foot: FloatArray
    ) -> FloatArray:
        """(6, 2, n) one step."""
        places, rotations, axes = self._forward(q)
        error = self._error(places[-1], rotations, target_m, foot)
        arms = (places[-1] - places) / self._length_m
        jacobian = np.concatenate([np.cross(axes, arms), axes], axis=-1)
        jacobian = np.moveaxis(jacobian, 0, -1)  # (2, n, 6, joints)
        across = np.swapaxes(jacobian, -1, -2)
        square = jacobian @ across + DAMPING**2 * np.eye(LEG_JOINTS)
        step = across @ np.linalg.solve(square, error[..., None])
        step = np.clip(step[..., 0], -LONGEST_RAD, LONGEST_RAD)
        return np.moveaxis(step, -1, 0)

    def _error(
        self,
        place_m: FloatArray,
        rotation: FloatArray,
        target_m: FloatArray,
        foot: FloatArray,
    ) -> FloatArray:
        shift = (target_m - place_m) / self._length_m
        turn = np.cross(rotation, foot, axis=-2).sum(axis=-1) / 2
        return np.concatenate([shift, turn], axis=-1)

    def _forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Where the joints are, (6, 2, n, 3), the feet's rotations, and the axes."""
        sine, cosine = np.sin(q)[..., None, None], 1.0 - np.cos(q)[..., None, None]
        shape = (*q.shape[1:], 3, 3)
        rotation = np.broadcast_to(np.eye(3), shape)
        place = np.zeros((*q.shape[1:], 3))
        places, axes = [], []
        for k in range(LEG_JOINTS):
            place = place + (rotation @ self._origins[k][:, None, :, None])[..., 0]
            places.append(place)
            axes.append((rotation @ self._axes[k][:, None, :, None])[..., 0])
            cross = self._skew[k][:, None]
            turn = np.eye(3) + sine[k] * cross + cosine[k] * (cross @ cross)
            rotation = rotation @ turn
        return np.stack(places), rotation, np.stack(axes)


def _skew(axis: FloatArray) -> FloatArray:
    """The (3, 3) matrix that takes the cross product with an axis."""
    a, b, c = axis
    return np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
