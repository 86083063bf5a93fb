"""Dry friction with true sticking (Coulomb, Stribeck, load), and LuGre friction."""

import math
from dataclasses import dataclass
from typing import Any, Self

from worlds.hidden.effects.kind import (
    HiddenKind,
    JointTorque,
    Quantity,
    StiffContact,
    Values,
)
from worlds.hidden.setting import Setting


@dataclass
class DryFriction:
    """Friction torque at a joint that sticks below a limit and slides at it.

    A very stiff bristle between the two surfaces bends with the motion until it carries
    the sliding torque, and then slips (elastic-plastic return mapping; Dupont, Hayward,
    Armstrong, Altpeter 2002, with the plastic branch entered at once). While it sticks,
    the bristle is critically damped so that it does not ring. The sliding torque is
    coulomb + extra exp(-(v / speed)^2) + load_share |servo torque| at joint speed v.
    """

    stiffness_nm_rad: float
    damping_nm_s_rad: float
    coulomb_nm: float = 0.0
    extra_nm: float = 0.0
    speed_rad_s: float = 1.0
    load_share: float = 0.0
    _bend_rad: float = 0.0
    _last_rad: float | None = None

    @classmethod
    def of(cls, contact: StiffContact, **terms: Any) -> Self:
        """Friction of given terms [N m]; it sticks as stiffly as the step allows."""
        stiffness = contact.stiffness_nm_rad(contact.rigid_nm_rad)
        return cls(stiffness, contact.damping_nm_s_rad(stiffness), **terms)

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        """Friction torque on the joint for the next step [N m]."""
        most = self.sliding_nm(speed_rad_s, servo_nm)
        if self._last_rad is not None:
            self._bend_rad += angle_rad - self._last_rad
        self._last_rad = angle_rad
        elastic = self.stiffness_nm_rad * self._bend_rad
        if abs(elastic) > most:
            elastic = math.copysign(most, elastic)
            self._bend_rad = elastic / self.stiffness_nm_rad
        total = elastic + self.damping_nm_s_rad * speed_rad_s
        return -max(-most, min(most, total))

    def sliding_nm(self, speed_rad_s: float, servo_nm: float) -> float:
        """The torque [N m] at which it slides."""
        most = self.coulomb_nm + self.load_share * abs(servo_nm)
        if self.extra_nm:
            most += self.extra_nm * math.exp(-((speed_rad_s / self.speed_rad_s) ** 2))
        return most


class CoulombFriction(HiddenKind):
    """Dry friction of constant torque against the motion, with sticking."""

    name = "coulomb_friction"
    rank = 2
    in_torques = True
    quantities = (Quantity("torque", "N m", 0.0),)
    needs_motion = True
    apart = ("stribeck_friction",)  # which has a Coulomb part of its own

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque, of constant size while the joint slides."""
        return DryFriction.of(contact, coulomb_nm=values["torque"]).torque

    def size(self, s: Setting) -> dict[str, float]:
        """Torque of 1 % (hard to detect) to 15 % (easy) of the servo's usual torque."""
        return {"torque": s.part(0.15, 0.01) * s.torque_nm}


class StribeckFriction(HiddenKind):
    """Coulomb friction that is larger near standstill."""

    name = "stribeck_friction"
    rank = 3
    in_torques = True
    quantities = (
        Quantity("coulomb_torque", "N m", 0.0),
        Quantity("extra_torque", "N m", 0.0),
        Quantity("speed", "rad/s", 1e-6),
    )
    needs_motion = True
    apart = ("coulomb_friction",)  # which is a part of it

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque: coulomb + extra exp(-(v / speed)^2)."""
        return DryFriction.of(
            contact,
            coulomb_nm=values["coulomb_torque"],
            extra_nm=values["extra_torque"],
            speed_rad_s=values["speed"],
        ).torque

    def size(self, s: Setting) -> dict[str, float]:
        """Coulomb part of 2 % (hard to detect) to 10 % (easy) of usual servo torque.

        The extra part is 0.5 to 1.5 times as large. Its speed is 3 to 30 % of the
        joint's top speed: else it could not be distinguished from Coulomb friction.
        """
        coulomb = s.part(0.1, 0.02) * s.torque_nm
        part = s.rng.uniform(math.log(0.03), math.log(0.3))
        return {
            "coulomb_torque": coulomb,
            "extra_torque": float(s.rng.uniform(0.5, 1.5)) * coulomb,
            "speed": math.exp(part) * s.speed_rad_s,
        }


class LoadFriction(HiddenKind):
    """Dry friction proportional to the torque that the servo transmits."""

    name = "load_friction"
    rank = 4
    in_torques = True
    quantities = (Quantity("share", "1", 0.0, 1.0),)
    sizes = (0.3, 0.03)

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque: share |servo torque| while the joint slides."""
        return DryFriction.of(contact, load_share=values["share"]).torque


@dataclass
class FrictionByAngle(DryFriction):
    """Dry friction that sticks; it changes by a factor for each rad.

    It is the Coulomb torque at `middle_rad`.
    """

    factor: float = 1.0
    middle_rad: float = 0.0

    def sliding_nm(self, speed_rad_s: float, servo_nm: float) -> float:
        """The torque [N m] at which it slides, at the angle of the last step."""
        angle_rad = self.middle_rad if self._last_rad is None else self._last_rad
        far_rad = angle_rad - self.middle_rad
        return self.coulomb_nm * math.exp(math.log(self.factor) * far_rad)


class AngleFriction(HiddenKind):
    """Dry friction that is larger at one end of the joint's range than at the other."""

    name = "angle_friction"
    since = 5
    in_torques = True
    quantities = (Quantity("torque", "N m", 0.0), Quantity("factor", "1", 0.01, 100.0))
    needs_motion = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque, `torque` in the middle of the joint's range."""
        return FrictionByAngle.of(
            contact,
            coulomb_nm=values["torque"],
            factor=values["factor"],
            middle_rad=contact.middle_rad,
        ).torque

    def size(self, s: Setting) -> dict[str, float]:
        """Torque of 3 % (hard to detect) to 15 % (easy) of the servo's usual torque.

        It changes by a factor of 2 to 4 for each rad, to either side.
        """
        factor = math.exp(s.sign * float(s.rng.uniform(math.log(2), math.log(4))))
        return {"torque": s.part(0.15, 0.03) * s.torque_nm, "factor": factor}


@dataclass
class SoftBristles:
    """LuGre friction without damping (Canudas de Wit, Olsson, Astrom, Lischinsky 1995).

    The bristles' bend z at joint speed v follows dz/dt = v - stiffness |v| z / F; the
    friction torque is stiffness z, and F = `torque_nm` after long sliding.
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
    in_torques = True
    quantities = (
        Quantity("torque", "N m", 1e-6),
        Quantity("stiffness", "N m/rad", 1e-6),
    )
    outside = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque: like a spring at first, like Coulomb's later."""
        return SoftBristles(
            values["torque"], values["stiffness"], contact.step_s
        ).torque

    def size(self, s: Setting) -> dict[str, float]:
        """Torque of 5 % (hard to detect) to 30 % (easy) of the servo's usual torque.

        The bristles bend by 0.03 to 0.12 rad under it.
        """
        torque = s.part(0.3, 0.05) * s.torque_nm
        return {
            "torque": torque,
            "stiffness": torque / float(s.rng.uniform(0.03, 0.12)),
        }
