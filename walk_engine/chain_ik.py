"""Inverse kinematics of legs whose joint axes do not meet in one point.

Damped Gauss-Newton steps. Let p and R be the position and rotation of the last joint
for the leg's angles q, and p* and R* their targets. With the joints' axes a_k and
positions p_k, the columns of the Jacobian J are (a_k x (p - p_k), a_k). The error is
e = (p* - p, 1/2 sum_i R e_i x R* e_i); its second half is, to second order, the turn
from R to R*. A step is

    q <- q + J^T (J J^T + d^2 E)^-1 e,

with lengths in units of the leg's length. The damping d and a largest step keep the
angles finite if the leg is straight or the target out of reach. The steps start from
the closed form of the most similar leg whose axes do meet, so that few are enough. All
robots take the same number of steps, so that no robot's bits depend on its neighbours.
"""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.leg_geometry import LEG_JOINTS, LegChain

STEPS = 5
"""Number of Gauss-Newton steps, the same for all robots."""

DAMPING = 0.003
"""Damping d of the Gauss-Newton steps, in leg lengths per radian."""

LONGEST_RAD = 0.5
"""Largest change of a joint angle in one Gauss-Newton step [rad]."""


class ChainLegs:
    """Solves the inverse kinematics of a left and a right leg of six joints each."""

    def __init__(self, chains: tuple[LegChain, LegChain], length_m: float) -> None:
        """Prepare the left and the right leg; `length_m` [m] is the unit of lengths."""
        # First axis: the joints of a leg; second axis: the two legs.
        self._origins = np.stack([chain.origins_m for chain in chains], axis=1)
        self._axes = np.stack([chain.axes for chain in chains], axis=1)
        self._chains = chains
        self._length_m = length_m
        self._skew = np.array([[_skew(axis) for axis in pair] for pair in self._axes])

    def angles(
        self, by_role_rad: FloatArray, ankle_m: FloatArray, foot: FloatArray
    ) -> FloatArray:
        """Joint angles that put both feet at their targets.

        Args:
          by_role_rad: (6, 2, n) angles to start from [rad]: those of the most similar
            leg whose axes meet, ordered like the result.
          ankle_m: (2, n, 3) target positions of the ankles in the torso's frame [m].
          foot: (2, n, 3, 3) target rotations from the feet's frames to the torso's.

        Returns:
          (6, 2, n) angles [rad] of yaw, roll, pitch, knee, ankle pitch and ankle roll,
          in the signs and zeros of the robot's joints.
        """
        q = np.empty(by_role_rad.shape)
        for side, chain in enumerate(self._chains):
            off = by_role_rad[:, side] - chain.zero_rad[:, None]
            q[chain.order, side] = chain.signs[:, None] * off
        shift = np.stack([chain.foot_m for chain in self._chains])
        target = ankle_m + (foot @ shift[:, None, :, None])[..., 0]
        for _ in range(STEPS):
            q = q + self._step(q, target, foot)
        return np.stack(
            [q[chain.order, side] for side, chain in enumerate(self._chains)], axis=1
        )

    def _step(
        self, q: FloatArray, target_m: FloatArray, foot: FloatArray
    ) -> FloatArray:
        """Change (6, 2, n) of the angles [rad] in one Gauss-Newton step."""
        places, rotations, axes = self._forward(q)
        shift = (target_m - places[-1]) / self._length_m
        turn = np.cross(rotations, foot, axis=-2).sum(axis=-1) / 2
        error = np.concatenate([shift, turn], axis=-1)
        arms = (places[-1] - places) / self._length_m
        jacobian = np.concatenate([np.cross(axes, arms), axes], axis=-1)
        jacobian = np.moveaxis(jacobian, 0, -1)  # (2, n, 6, joints)
        across = np.swapaxes(jacobian, -1, -2)
        square = jacobian @ across + DAMPING**2 * np.eye(LEG_JOINTS)
        step = across @ np.linalg.solve(square, error[..., None])
        step = np.clip(step[..., 0], -LONGEST_RAD, LONGEST_RAD)
        return np.moveaxis(step, -1, 0)

    def _forward(self, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Joints (6, 2, n, 3) [m], feet's rotations (2, n, 3, 3), axes (6, 2, n, 3)."""
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
    """Matrix (3, 3) whose product with a vector v is the cross product axis x v."""
    a, b, c = axis
    return np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])
