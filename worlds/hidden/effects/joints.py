"""Hidden physics of joints: torques by angle, speed or time; play and elasticity."""

import math

from worlds.hidden.effects.kind import (
    HiddenKind,
    JointTorque,
    Quantity,
    StiffContact,
    Values,
)
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.servos import Transmission
from worlds.hidden.setting import Setting

_STOP_SHARE = 1 / 6
"""Stiffness of an end stop as a share of that of gear teeth: 500 N m/rad with servos of
a few N m, which compress it by less than 0.01 rad, as hard rubber at a radius of some
centimetres."""


class ViscousFriction(HiddenKind):
    """Friction torque proportional to the joint's speed."""

    name = "viscous_friction"
    rank = 1
    in_torques = True
    quantities = (Quantity("coefficient", "N m s/rad", 0.0),)
    needs_motion = True
    apart = ("servo_damping",)

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque: -coefficient v at joint speed v."""
        coefficient = values["coefficient"]
        return lambda time_s, angle, speed, servo: -coefficient * speed

    def size(self, s: Setting) -> dict[str, float]:
        """At top speed 2 % (hard to detect) to 20 % (easy) of usual servo torque."""
        return {"coefficient": s.part(0.2, 0.02) * s.torque_nm / s.speed_rad_s}

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether all servo damping is back-EMF, which acts like viscous friction."""
        return not plant.kd_nm_s_rad.any()


class JointSpring(HiddenKind):
    """A spring that pulls the joint towards a rest angle."""

    name = "joint_spring"
    rank = 18
    in_torques = True
    quantities = (
        Quantity("stiffness", "N m/rad", 0.0),
        Quantity("rest", "rad", -6.3, 6.3),
    )

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the spring's torque: -stiffness (q - rest) at joint angle q."""
        stiffness, rest = values["stiffness"], values["rest"]
        return lambda time_s, angle, speed, servo: -stiffness * (angle - rest)

    def size(self, s: Setting) -> dict[str, float]:
        """Stiffness of 1 % (hard to detect) to 30 % (easy) of the servo's stiffness.

        The rest angle is drawn from the range of the motion.
        """
        low, high = s.scales.reach_rad[s.joint]
        return {
            "stiffness": s.part(0.3, 0.01) * float(s.plant.kp_nm_rad[s.joint]),
            "rest": float(s.rng.uniform(low, high)),
        }


class EndStop(HiddenKind):
    """A stop that keeps the joint from going beyond an angle.

    It is a stiff spring and damper that only push back. The joint is kept below `angle`
    where `side` is +1 and above it where `side` is -1.
    """

    name = "end_stop"
    rank = 19
    in_torques = True
    quantities = (
        Quantity("angle", "rad"),
        Quantity("side", "1", -1.0, 1.0),
    )

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the stop's torque: 0 before it; beyond, a spring and damper's push."""
        stop, side = values["angle"], values["side"]
        stiffness = contact.stiffness_nm_rad(_STOP_SHARE * contact.rigid_nm_rad)
        damping = contact.damping_nm_s_rad(stiffness)

        def push(time_s: float, angle: float, speed: float, servo: float) -> float:
            beyond = (angle - stop) * side
            if beyond <= 0:
                return 0.0
            return -side * max(stiffness * beyond + damping * speed * side, 0.0)

        return push

    def size(self, s: Setting) -> dict[str, float]:
        """Stop at 90 % (hard to detect) to 30 % (easy) of the motion's amplitude."""
        low, high = s.scales.reach_rad[s.joint]
        side, half = s.sign, (high - low) / 2
        return {
            "angle": float((low + high) / 2 + side * s.part(0.3, 0.9) * half),
            "side": side,
        }


def _ripple(values: Values, rate: float, along: int) -> JointTorque:
    """The torque `torque` sin(rate x + phase); x is the time (0) or the angle (1)."""
    amplitude, phase = values["torque"], values["phase"]
    return lambda *state: amplitude * math.sin(rate * state[along] + phase)


class Cogging(HiddenKind):
    """Torque ripple that repeats with the joint's angle."""

    name = "cogging"
    rank = 28
    in_torques = True
    quantities = (
        Quantity("torque", "N m", 0.0),
        Quantity("per_turn", "1", 0.0),
        Quantity("phase", "rad"),
    )
    outside = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the ripple: `torque` sin(per_turn q + phase) at joint angle q."""
        return _ripple(values, values["per_turn"], along=1)

    def size(self, s: Setting) -> dict[str, float]:
        """Torque of 3 % (hard to detect) to 30 % (easy) of the servo's usual torque."""
        return {
            "torque": s.part(0.3, 0.03) * s.torque_nm,
            "per_turn": float(s.rng.integers(12, 60)),
            "phase": float(s.rng.uniform(0, 2 * math.pi)),
        }


class PeriodicTorque(HiddenKind):
    """A disturbing torque that repeats with time."""

    name = "periodic_torque"
    rank = 30
    in_torques = True
    quantities = (
        Quantity("torque", "N m", 0.0),
        Quantity("frequency", "Hz", 0.0),
        Quantity("phase", "rad"),
    )
    outside = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the torque: `torque` sin(2 pi frequency t + phase) at time t."""
        return _ripple(values, 2 * math.pi * values["frequency"], along=0)

    def size(self, s: Setting) -> dict[str, float]:
        """Torque of 2 % (hard to detect) to 20 % (easy) of the servo's usual torque."""
        return {
            "torque": s.part(0.2, 0.02) * s.torque_nm,
            "frequency": float(s.rng.uniform(0.7, 6.0)),
            "phase": float(s.rng.uniform(0, 2 * math.pi)),
        }


class Backlash(HiddenKind):
    """Play between gear teeth, with the encoder at the joint."""

    name = "backlash"
    rank = 5
    stiff = True
    quantities = (Quantity("gap", "rad", 0.0, 0.5),)
    sizes = (0.06, 0.003)
    apart = ("joint_elasticity",)  # a joint can have one of the two

    def transmission(self, values: Values, contact: StiffContact) -> Transmission:
        """A gear with play; its teeth are as stiff as the time step allows."""
        stiffness = contact.stiffness_nm_rad(contact.rigid_nm_rad)
        return Transmission(stiffness, 0.0, values["gap"], contact.step_s)


class JointElasticity(HiddenKind):
    """A spring and damper between motor and joint, with the encoder at the motor."""

    name = "joint_elasticity"
    rank = 6
    stiff = True
    quantities = (
        Quantity("stiffness", "N m/rad", 0.0),
        Quantity("damping", "N m s/rad", 0.0),
    )
    apart = ("backlash",)  # a joint can have one of the two

    def transmission(self, values: Values, contact: StiffContact) -> Transmission:
        """A gear that is a spring and damper without play."""
        return Transmission(
            values["stiffness"],
            values["damping"],
            0.0,
            contact.step_s,
            encoder_at_motor=True,
        )

    def size(self, s: Setting) -> dict[str, float]:
        """Stiffness of 2000 (hard to detect) to 50 N m/rad (easy), lightly damped."""
        stiffness = s.part(50.0, 2000.0)
        critical = 2 * math.sqrt(stiffness * float(s.scales.inertia_kg_m2[s.joint]))
        return {
            "stiffness": stiffness,
            "damping": float(s.rng.uniform(0.01, 0.05) * critical),
        }
