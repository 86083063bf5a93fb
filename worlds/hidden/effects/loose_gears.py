"""Hidden physics between a motor and its joint: play and elasticity."""

import math

from worlds.hidden.effects.dry_friction import RIGID_NM_RAD
from worlds.hidden.effects.kind import HiddenKind, Quantity, StiffContact, Values
from worlds.hidden.setting import Setting
from worlds.hidden.transmission import Transmission


class Backlash(HiddenKind):
    """Play between gear teeth, with the encoder at the joint."""

    name = "backlash"
    rank = 5
    quantities = (Quantity("gap", "rad", 0.0, 0.5),)
    sizes = (0.06, 0.003)
    apart = ("joint_elasticity",)  # a joint can have one of the two

    def transmission(self, values: Values, contact: StiffContact) -> Transmission:
        """A gear with play; its teeth are as stiff as the time step allows."""
        stiffness = contact.stiffness_nm_rad(RIGID_NM_RAD)
        return Transmission(stiffness, 0.0, values["gap"], contact.step_s)


class JointElasticity(HiddenKind):
    """A spring and damper between motor and joint, with the encoder at the motor."""

    name = "joint_elasticity"
    rank = 6
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
