"""Hidden friction that acts as many small springs before it slides (Maxwell slip)."""

import math

import numpy as np

from worlds.hidden.effects.kind import (
    HiddenKind,
    JointTorque,
    Quantity,
    StiffContact,
    Values,
)
from worlds.hidden.setting import Setting

ELEMENTS = 8
"""Number of elements in parallel: enough for a smooth curve."""


class MaxwellSlip:
    """Elements in parallel, each a spring that slips at its own deflection.

    Element i of n is a spring of stiffness k whose deflection z_i follows the joint up
    to +-d_i, d_i = reach i / n; the torque is -k sum z_i. After long sliding it is
    `torque_nm`, so that k = 2 torque / (reach (n + 1)). It depends on where the joint
    turned last and not on speed (Lampaert, Al-Bender and Swevers 2003, "A generalized
    Maxwell-slip friction model appropriate for control purposes", without its Stribeck
    part; hysteresis with nonlocal memory, whose branches follow Masing's rule).
    """

    def __init__(self, torque_nm: float, reach_rad: float) -> None:
        """Begin with all springs relaxed."""
        self._most_rad = reach_rad * np.arange(1, ELEMENTS + 1) / ELEMENTS
        self._stiffness_nm_rad = 2 * torque_nm / (reach_rad * (ELEMENTS + 1))
        self._bend_rad = np.zeros(ELEMENTS)
        self._last_rad: float | None = None

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        """Friction torque on the joint for the next step [N m]."""
        if self._last_rad is not None:
            bend = self._bend_rad + (angle_rad - self._last_rad)
            self._bend_rad = np.minimum(
                np.maximum(bend, -self._most_rad), self._most_rad
            )
        self._last_rad = angle_rad
        return -self._stiffness_nm_rad * float(self._bend_rad.sum())


class Presliding(HiddenKind):
    """Friction with a long way of small springs before it slides, with memory."""

    name = "presliding"
    rank = 36
    since = 2
    in_torques = True
    quantities = (
        Quantity("torque", "N m", 1e-6),
        Quantity("reach", "rad", 1e-6),
    )
    outside = True
    needs_motion = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque, see `MaxwellSlip`."""
        return MaxwellSlip(values["torque"], values["reach"]).torque

    def size(self, s: Setting) -> dict[str, float]:
        """Torque of 2 % (hard to detect) to 30 % (easy) of the servo's usual torque.

        It slides after 0.02 to 0.15 rad, as geared servos do; metal on metal slides
        after 1e-4 rad, which no encoder here could tell from Coulomb friction.
        """
        reach = math.exp(s.rng.uniform(math.log(0.02), math.log(0.15)))
        return {"torque": s.part(0.3, 0.02) * s.torque_nm, "reach": reach}
