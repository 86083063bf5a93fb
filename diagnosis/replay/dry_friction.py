"""Dry friction of joints beyond Coulomb's, by speed, angle and the load of gears.

Source: Duclusaud, Passault, Padois and Ly 2024, "Extended friction models for the
physics simulation of servo actuators" (models M1 to M6), and for the square term the
authors' program bam, `bam/model.py`, where only opposed torques count.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from groundwalk.arrays import FloatArray

SHARES_OF_LINKS = ("link_share", "extra_link_share", "extra_square_1_nm")
"""Attributes of `Joints` that need to know the torques that links put on joints."""

VARYING = (
    *("stribeck_nm", "angle_nm", "load_share", "extra_load_share"),
    *SHARES_OF_LINKS,
)
"""Attributes of `Joints` that make dry friction depend on speed, angle or load."""

MOST_NATS = 5.0
"""Largest logarithm of the factor by which friction changes with the angle, so that no
joint far from its range stops the simulation."""

MOST_STEPS = 30
"""Most steps of Newton's method; it needs a few."""

LEAST_SLOPE = 0.05
"""Smallest slope that Newton's method assumes: friction that takes 95 % of any further
torque of a motor. With a larger share no motor could turn its gear."""


def depends_on(joints: Mapping[str, FloatArray], names: Sequence[str]) -> bool:
    """Whether any of these attributes of `Joints`, by name, is not 0 everywhere."""
    return any(bool(joints[name].any()) for name in names)


class DryFriction:
    """Largest dry friction of joints beyond Coulomb's, at known speeds and angles.

    With w the joint's speed, T the motor's torque (back-EMF included) and L the torque
    that gravity and the links' motion put on the joint, both along the joint, it is
      |k_L L - k_T T| + exp(-|w / v|^a) (t + |e_L L - e_T T| + q P^2)
      + r (exp(g z) - 1),
    with r the part of Coulomb's friction that changes with the angle z. The last term
    may be below zero, its sum with Coulomb's friction is not.
    Opposed torques press on the gear from both sides, so that shares of them add up.
    P is the smaller one of the two if they are opposed, else 0: what passes through the
    gear from one side to the other. One q stands for both ways, motor drives links and
    links drive motor. All arrays have shapes that broadcast.
    """

    def __init__(
        self,
        joints: Mapping[str, FloatArray],
        velocity_rad_s: FloatArray,
        links_nm: FloatArray | float = 0.0,
        position_rad: FloatArray | float = 0.0,
    ) -> None:
        """Take arrays of `Joints` by name, speeds, torques L [N m] of links, angles."""
        speed = np.abs(velocity_rad_s / joints["stribeck_speed_rad_s"])
        self._slow = np.exp(-(speed ** joints["stribeck_exponent"]))
        self._joints, self._links_nm = joints, links_nm
        self._by_angle_nm = joints["angle_nm"]
        if self._by_angle_nm.any():
            far_rad = position_rad - joints["angle_from_rad"]
            grown = np.clip(joints["angle_log_1_rad"] * far_rad, -MOST_NATS, MOST_NATS)
            self._by_angle_nm = self._by_angle_nm * np.expm1(grown)

    def at(self, motor_nm: FloatArray | float) -> FloatArray:
        """Friction [N m] at motor torques T [N m]."""
        joints = self._joints
        always, slow = self._loads(motor_nm)
        carried = self._carried(motor_nm)
        extra = joints["stribeck_nm"] + np.abs(slow)
        extra = extra + joints["extra_square_1_nm"] * carried**2
        return np.asarray(np.abs(always) + self._slow * extra + self._by_angle_nm)

    def needed_nm(self, free_nm: FloatArray, way: FloatArray) -> FloatArray:
        """Motor torques T [N m] with T = free + way friction(T).

        `free_nm` is the torque without this friction, `way` the sign of the speed. The
        right side minus the left one is concave or convex in T, so that Newton's method
        does not miss the root while friction takes less than all of a further torque.
        """
        torque = np.array(free_nm, float)
        for _ in range(MOST_STEPS):
            missed = torque - free_nm - way * self.at(torque)
            slope = 1 - way * self._slope(torque)
            step = missed / np.maximum(slope, LEAST_SLOPE)
            torque -= step
            if np.all(np.abs(step) <= 1e-12 * (1 + np.abs(torque))):
                break
        return torque

    def _loads(self, motor_nm: FloatArray | float) -> tuple[FloatArray, FloatArray]:
        """What shares of torques add up to, at all speeds and near standstill."""
        joints, links_nm = self._joints, self._links_nm
        always = joints["link_share"] * links_nm - joints["load_share"] * motor_nm
        slow = joints["extra_link_share"] * links_nm
        return always, slow - joints["extra_load_share"] * motor_nm

    def _carried(self, motor_nm: FloatArray | float) -> FloatArray:
        """The torque P [N m], at least 0."""
        smaller = np.minimum(np.abs(motor_nm), np.abs(self._links_nm))
        return np.where(motor_nm * self._links_nm < 0, smaller, 0.0)

    def _slope(self, motor_nm: FloatArray) -> FloatArray:
        """Derivative of the friction by the motor's torque."""
        joints = self._joints
        always, slow = self._loads(motor_nm)
        carried = self._carried(motor_nm)
        # where the links' torque is the smaller one, the motor's makes no difference
        own = np.where(np.abs(motor_nm) < np.abs(self._links_nm), carried, 0.0)
        square = 2 * joints["extra_square_1_nm"] * own * np.sign(motor_nm)
        extra = square - joints["extra_load_share"] * np.sign(slow)
        return np.asarray(self._slow * extra - joints["load_share"] * np.sign(always))
