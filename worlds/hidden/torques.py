"""Hidden physics that is a torque at one joint, of its angle, speed and the time."""

import math
from dataclasses import dataclass
from typing import Protocol

from worlds.hidden.effects import Hidden
from worlds.hidden.friction import DryFriction, LugreHysteresis

_RIGID_NM_RAD, _STOP_NM_RAD = 3000.0, 500.0
"""Of surfaces that stick and teeth that touch, and of a stop's rubber."""
_MOST = 0.15
"""Stiffness in units of inertia / step^2; a semi-implicit step can follow up to 4."""
_DAMPING_RATIO = 1.0


class JointTorque(Protocol):
    """What acts at a joint besides its servo."""

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        """Torque on the joint for the next fine step [N m].

        Args:
          time_s: in the recording's time.
          angle_rad: of the joint.
          speed_rad_s: of the joint.
          servo_nm: the servo's torque.
        """


@dataclass
class _Viscous:
    coefficient: float

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        return -self.coefficient * speed_rad_s


@dataclass
class _Spring:
    stiffness: float
    rest: float

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        return -self.stiffness * (angle_rad - self.rest)


@dataclass
class _EndStop:
    """A stiff spring and damper that only pushes back."""

    angle: float
    side: float
    stiffness: float
    damping: float

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        beyond = (angle_rad - self.angle) * self.side
        if beyond <= 0:
            return 0.0
        push = self.stiffness * beyond + self.damping * speed_rad_s * self.side
        return -self.side * max(push, 0.0)


@dataclass
class _Cogging:
    """Torque ripple that comes back with the angle."""

    amplitude: float
    per_turn: float
    phase: float

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        return self.amplitude * math.sin(self.per_turn * angle_rad + self.phase)


@dataclass
class _Wave:
    """A disturbance that comes back with time."""

    amplitude: float
    frequency: float
    phase: float

    def torque(
        self, time_s: float, angle_rad: float, speed_rad_s: float, servo_nm: float
    ) -> float:
        turns = 2 * math.pi * self.frequency * time_s
        return self.amplitude * math.sin(turns + self.phase)


def joint_torque(
    effect: Hidden, inertia_kg_m2: float, step_s: float
) -> JointTorque | None:
    """The effect as a torque of its own; None if it is not one.

    Args:
      effect: any.
      inertia_kg_m2: least inertia that the joint moves, for stiff contacts.
      step_s: time step.
    """
    match effect.name:
        case "viscous_friction":
            return _Viscous(effect["coefficient"])
        case "joint_spring":
            return _Spring(effect["stiffness"], effect["rest"])
        case "end_stop":
            stiff = _stiff(_STOP_NM_RAD, inertia_kg_m2, step_s)
            return _EndStop(effect["angle"], effect["side"], *stiff)
        case "cogging":
            return _Cogging(effect["torque"], effect["per_turn"], effect["phase"])
        case "periodic_torque":
            return _Wave(effect["torque"], effect["frequency"], effect["phase"])
        case "lugre_hysteresis":
            return LugreHysteresis(effect["torque"], effect["stiffness"], step_s)
    return _dry(effect, *_stiff(_RIGID_NM_RAD, inertia_kg_m2, step_s))


def _stiff(wanted: float, inertia_kg_m2: float, step_s: float) -> tuple[float, float]:
    """Stiffness and damping of a contact, as wanted if steps can follow it."""
    stiffness = min(wanted, _MOST * inertia_kg_m2 / step_s**2)
    return stiffness, 2 * _DAMPING_RATIO * math.sqrt(stiffness * inertia_kg_m2)


def rigid_nm_rad(inertia_kg_m2: float, step_s: float) -> float:
    """Stiffness of what counts as rigid at a joint and a step."""
    return _stiff(_RIGID_NM_RAD, inertia_kg_m2, step_s)[0]


def _dry(effect: Hidden, stiffness: float, damping: float) -> DryFriction | None:
    match effect.name:
        case "coulomb_friction":
            return DryFriction(stiffness, damping, effect["torque"])
        case "stribeck_friction":
            values = [effect[n] for n in ("coulomb_torque", "extra_torque", "speed")]
            return DryFriction(stiffness, damping, *values)
        case "load_friction":
            return DryFriction(stiffness, damping, load_share=effect["share"])
    return None
