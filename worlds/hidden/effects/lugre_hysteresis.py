"""Friction with bristles so soft that their memory spans the motion."""

import math
from dataclasses import dataclass

from worlds.hidden.effects.kind import (
    HiddenKind,
    JointTorque,
    Quantity,
    StiffContact,
    Values,
)
from worlds.hidden.setting import Setting


@dataclass
class SoftBristles:
    """LuGre friction (Canudas de Wit, Olsson, Astrom, Lischinsky 1995), no damping.

    dz/dt = v - stiffness |v| z / F, torque = stiffness z, here with a constant F.

    Attributes:
      torque_nm: F, reached after long sliding.
      stiffness_nm_rad: of the bristles.
      step_s: time step.
    """

    torque_nm: float
    stiffness_nm_rad: float
    step_s: float
    _bend_rad: float = 0.0

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        """Friction torque on the joint for the next step [N m]."""
        rate = self.stiffness_nm_rad * abs(speed_rad_s) / self.torque_nm
        steady = math.copysign(self.torque_nm / self.stiffness_nm_rad, speed_rad_s)
        decay = math.exp(-rate * self.step_s)
        self._bend_rad = steady + (self._bend_rad - steady) * decay
        return -self.stiffness_nm_rad * self._bend_rad


class LugreHysteresis(HiddenKind):
    """Friction that acts as a spring at first and slides only after some degrees."""

    name = "lugre_hysteresis"
    rank = 27
    quantities = (
        Quantity("torque", "N m", 1e-6),
        Quantity("stiffness", "N m/rad", 1e-6),
    )
    outside = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """See `SoftBristles`."""
        return SoftBristles(
            values["torque"], values["stiffness"], contact.step_s
        ).torque

    def size(self, s: Setting) -> dict[str, float]:
        """From 5 % to 30 % of the servo's torque, reached after 0.03 to 0.12 rad."""
        torque = s.part(0.3, 0.05) * s.torque_nm
        return {
            "torque": torque,
            "stiffness": torque / float(s.rng.uniform(0.03, 0.12)),
        }
