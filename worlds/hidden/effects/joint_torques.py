"""Hidden physics that is a torque at one joint, of its angle, its speed or the time."""

import math

from worlds.hidden.effects.kind import (
    HiddenKind,
    JointTorque,
    Quantity,
    StiffContact,
    Values,
)
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Setting

_STOP_NM_RAD = 500.0
"""Stiffness of an end stop: hard rubber on a lever of some centimetres. A servo's
torque of a few N m dents it by less than 0.01 rad."""


class ViscousFriction(HiddenKind):
    """Friction torque proportional to the joint's speed."""

    name = "viscous_friction"
    rank = 1
    quantities = (Quantity("coefficient", "N m s/rad", 0.0),)
    needs_motion = True
    apart = ("servo_damping",)

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Torque -coefficient v, with v the joint's speed."""
        coefficient = values["coefficient"]
        return lambda time_s, angle, speed, servo: -coefficient * speed

    def size(self, s: Setting) -> dict[str, float]:
        """At top speed from 2 % (hard to see) to 20 % (easy) of the servo's torque."""
        return {"coefficient": s.part(0.2, 0.02) * s.torque_nm / s.speed_rad_s}

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether all damping is back-EMF: less of it and more friction then cancel."""
        return not plant.kd_nm_s_rad.any()


class JointSpring(HiddenKind):
    """A spring pulls the joint towards a rest angle."""

    name = "joint_spring"
    rank = 18
    quantities = (
        Quantity("stiffness", "N m/rad", 0.0),
        Quantity("rest", "rad", -6.3, 6.3),
    )

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Torque -stiffness (q - rest), with q the joint's angle."""
        stiffness, rest = values["stiffness"], values["rest"]
        return lambda time_s, angle, speed, servo: -stiffness * (angle - rest)

    def size(self, s: Setting) -> dict[str, float]:
        """Stiffness from 1 % (hard to see) to 30 % (easy) of the servo's."""
        low, high = s.scales.reach_rad[s.joint]
        return {
            "stiffness": s.part(0.3, 0.01) * float(s.plant.kp_nm_rad[s.joint]),
            "rest": float(s.rng.uniform(low, high)),
        }


class EndStop(HiddenKind):
    """A stop keeps the joint from going beyond an angle.

    The stop is a stiff spring and damper that only push back. It is above the joint
    where `side` is +1 and below it where `side` is -1.
    """

    name = "end_stop"
    rank = 19
    quantities = (
        Quantity("angle", "rad"),
        Quantity("side", "1", -1.0, 1.0),
    )

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Nothing before the stop; beyond it a spring and damper that only push."""
        stop, side = values["angle"], values["side"]
        stiffness = contact.stiffness_nm_rad(_STOP_NM_RAD)
        damping = contact.damping_nm_s_rad(stiffness)

        def push(time_s: float, angle: float, speed: float, servo: float) -> float:
            beyond = (angle - stop) * side
            if beyond <= 0:
                return 0.0
            return -side * max(stiffness * beyond + damping * speed * side, 0.0)

        return push

    def size(self, s: Setting) -> dict[str, float]:
        """A stop at 90 % (hard to see) to 30 % (easy) of the motion's half width."""
        low, high = s.scales.reach_rad[s.joint]
        side, half = s.sign, (high - low) / 2
        return {
            "angle": float((low + high) / 2 + side * s.part(0.3, 0.9) * half),
            "side": side,
        }


class Cogging(HiddenKind):
    """Torque ripple that repeats with the joint's angle."""

    name = "cogging"
    rank = 28
    quantities = (
        Quantity("torque", "N m", 0.0),
        Quantity("per_turn", "1", 0.0),
        Quantity("phase", "rad"),
    )
    outside = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Ripple `torque` sin(per_turn q + phase), with q the joint's angle."""
        amplitude, per_turn = values["torque"], values["per_turn"]
        phase = values["phase"]
        return lambda time_s, angle, speed, servo: (
            amplitude * math.sin(per_turn * angle + phase)
        )

    def size(self, s: Setting) -> dict[str, float]:
        """Torque from 3 % (hard to see) to 30 % (easy) of the servo's usual one."""
        return {
            "torque": s.part(0.3, 0.03) * s.torque_nm,
            "per_turn": float(s.rng.integers(12, 60)),
            "phase": float(s.rng.uniform(0, 2 * math.pi)),
        }


class PeriodicTorque(HiddenKind):
    """A disturbing torque that repeats with time."""

    name = "periodic_torque"
    rank = 30
    quantities = (
        Quantity("torque", "N m", 0.0),
        Quantity("frequency", "Hz", 0.0),
        Quantity("phase", "rad"),
    )
    outside = True

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Disturbance `torque` sin(2 pi frequency t + phase), with t the time."""
        amplitude, frequency = values["torque"], values["frequency"]
        phase = values["phase"]

        def wave(time_s: float, angle: float, speed: float, servo: float) -> float:
            turns = 2 * math.pi * frequency * time_s
            return amplitude * math.sin(turns + phase)

        return wave

    def size(self, s: Setting) -> dict[str, float]:
        """Torque from 2 % (hard to see) to 20 % (easy) of the servo's usual one."""
        return {
            "torque": s.part(0.2, 0.02) * s.torque_nm,
            "frequency": float(s.rng.uniform(0.7, 6.0)),
            "phase": float(s.rng.uniform(0, 2 * math.pi)),
        }
