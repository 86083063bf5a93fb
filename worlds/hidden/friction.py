"""Dry friction with true sticking, and its kin with memory; one joint each."""

import math
from dataclasses import dataclass


@dataclass
class DryFriction:
    """Friction that holds still below breakaway and slides above.

    A very stiff bristle between the two surfaces bends with the motion until it
    carries the sliding torque, and then slips (elastic-plastic return mapping;
    Dupont, Hayward, Armstrong, Altpeter 2002, with the plastic branch entered at
    once). While it sticks it is damped, so that it does not ring.

    Attributes:
      stiffness_nm_rad, damping_nm_s_rad: of the bristle, as stiff as steps allow.
      coulomb_nm: sliding torque.
      extra_nm, speed_rad_s: Stribeck: extra exp(-(v / speed)^2) more near standstill.
      load_share: and this share of the servo's torque.
    """

    stiffness_nm_rad: float
    damping_nm_s_rad: float
    coulomb_nm: float = 0.0
    extra_nm: float = 0.0
    speed_rad_s: float = 1.0
    load_share: float = 0.0
    _bend_rad: float = 0.0
    _last_rad: float | None = None

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        """Friction torque on the joint for the next step."""
        most = self.coulomb_nm + self.load_share * abs(servo_nm)
        if self.extra_nm:
            most += self.extra_nm * math.exp(-((speed_rad_s / self.speed_rad_s) ** 2))
        if self._last_rad is not None:
            self._bend_rad += angle_rad - self._last_rad
        self._last_rad = angle_rad
        elastic = self.stiffness_nm_rad * self._bend_rad
        if abs(elastic) > most:
            elastic = math.copysign(most, elastic)
            self._bend_rad = elastic / self.stiffness_nm_rad
        total = elastic + self.damping_nm_s_rad * speed_rad_s
        return -max(-most, min(most, total))


@dataclass
class LugreHysteresis:
    """LuGre friction with bristles so soft that their memory spans the motion.

    Canudas de Wit, Olsson, Astrom, Lischinsky 1995: dz/dt = v - stiffness |v| z / F,
    torque = stiffness z + sqrt(stiffness) s dz/dt, here with a constant F.

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
        """Friction torque on the joint for the next step."""
        rate = self.stiffness_nm_rad * abs(speed_rad_s) / self.torque_nm
        steady = math.copysign(self.torque_nm / self.stiffness_nm_rad, speed_rad_s)
        decay = math.exp(-rate * self.step_s)
        self._bend_rad = steady + (self._bend_rad - steady) * decay
        return -self.stiffness_nm_rad * self._bend_rad
