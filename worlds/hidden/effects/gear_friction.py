"""Hidden dry friction of servo gears: the upper rungs of a ladder of models.

M2 to M6 of Duclusaud, Passault, Padois and Ly 2024, "Extended friction models for the
physics simulation of servo actuators"; M1 and M2 with exponent 2 are in
`dry_friction.py`, viscous friction is a kind of its own.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

from worlds.hidden.effects.dry_friction import DryFriction
from worlds.hidden.effects.kind import (
    HiddenKind,
    JointTorque,
    Quantity,
    StiffContact,
    Values,
)
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Setting


@dataclass(frozen=True)
class Sides:
    """Friction of a gear by the torques on its two sides: shares and a square term.

    Where motor and links turn the gear against each other, it is pressed by a share of
    the one and a share of the other, and once more by the square [1/(N m)] of what goes
    through from side to side: the weaker of the two. Where both turn it the same way,
    one side takes the load off the other.
    """

    of_links: float = 0.0
    of_motor: float = 0.0
    square_1_nm: float = 0.0

    def friction_nm(self, links_nm: float, motor_nm: float) -> float:
        """Friction [N m], at least 0, under torques [N m] that turn the joint."""
        by_links = self.of_links * abs(links_nm)
        by_motor = self.of_motor * abs(motor_nm)
        if links_nm * motor_nm < 0:
            through = min(abs(links_nm), abs(motor_nm))
            return by_links + by_motor + self.square_1_nm * through * through
        return abs(by_links - by_motor)


@dataclass
class GearFriction(DryFriction):
    """Dry friction that sticks, with loads and a peak of any shape near standstill.

    The peak's share is 1 at rest and drops to 37 % at `speed_rad_s`.
    """

    exponent: float = 2.0
    always: Sides = Sides()
    near_rest: Sides = Sides()
    links_nm: Callable[[], float] = float

    def sliding_nm(self, speed_rad_s: float, servo_nm: float) -> float:
        """The torque [N m] at which it slides."""
        links_nm = self.links_nm()
        rest_nm = self.extra_nm + self.near_rest.friction_nm(links_nm, servo_nm)
        share = math.exp(-((abs(speed_rad_s) / self.speed_rad_s) ** self.exponent))
        moving_nm = self.coulomb_nm + self.always.friction_nm(links_nm, servo_nm)
        return moving_nm + share * rest_nm


_PEAK = (
    Quantity("coulomb_torque", "N m", 0.0),
    Quantity("extra_torque", "N m", 0.0),
    Quantity("speed", "rad/s", 1e-6),
    Quantity("exponent", "1", 0.1, 50.0),
)


class _Rung(HiddenKind):
    """A rung of the ladder; values that it lacks are 0, or one for both sides."""

    in_torques = True
    needs_motion = True
    since = 5  # no set of concealed cases has it yet

    def torque(self, values: Values, contact: StiffContact) -> JointTorque:
        """Law of the friction torque, see `GearFriction`."""
        share, extra_share = values.get("share", 0.0), values.get("extra_share", 0.0)
        return GearFriction.of(
            contact,
            coulomb_nm=values["coulomb_torque"],
            extra_nm=values.get("extra_torque", 0.0),
            speed_rad_s=values.get("speed", 1.0),
            exponent=values.get("exponent", 2.0),
            always=Sides(
                values.get("link_share", share), values.get("motor_share", share)
            ),
            near_rest=Sides(
                values.get("extra_link_share", extra_share),
                values.get("extra_motor_share", extra_share),
                values.get("extra_square", 0.0),
            ),
            links_nm=contact.links_nm,
        ).torque

    def size(self, s: Setting) -> dict[str, float]:
        """Torques of 2 % (hard to detect) to 10 % (easy), shares of 3 to 15 %.

        Torques are parts of the servo's usual one, of which the square term makes up as
        much as a share does. Speeds are 3 to 30 % of the joint's top speed.
        """
        torque, share = s.part(0.1, 0.02) * s.torque_nm, s.part(0.15, 0.03)
        part = s.rng.uniform(math.log(0.03), math.log(0.3))
        known = {
            "coulomb_torque": torque,
            "extra_torque": float(s.rng.uniform(0.5, 1.5)) * torque,
            "speed": math.exp(part) * s.speed_rad_s,
            "exponent": float(s.rng.uniform(1.0, 4.0)),
            "extra_square": share / s.torque_nm,
        }
        return {
            one.name: known[one.name]
            if one.name in known
            else share * float(s.rng.uniform(0.5, 1.5))
            for one in self.quantities
        }


class _Loaded(_Rung):
    """A rung with friction by the torques of motor and links, on a fixed base."""

    fixed_base_only = True

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the base is fixed: ground under feet would load the gears, too."""
        return not plant.floating


class ShapedStribeck(_Rung):
    """Dry friction with a peak near standstill of any exponent: M2."""

    name = "shaped_stribeck_friction"
    quantities = _PEAK


class LoadedGear(_Loaded):
    """Dry friction and a share of the torques on both sides of the gear: M3."""

    name = "gear_friction"
    quantities = (_PEAK[0], Quantity("share", "1", 0.0, 1.0))


class LoadedStribeck(_Loaded):
    """Dry friction with a peak, and shares of the gear's torques in both parts: M4."""

    name = "gear_stribeck_friction"
    quantities = (
        *_PEAK,
        Quantity("share", "1", 0.0, 1.0),
        Quantity("extra_share", "1", 0.0, 1.0),
    )


class DirectionalGear(_Loaded):
    """M5: M4 with one share of the motor's torque and another of the links'."""

    name = "directional_gear_friction"
    quantities = (
        *_PEAK,
        Quantity("link_share", "1", 0.0, 1.0),
        Quantity("motor_share", "1", 0.0, 1.0),
        Quantity("extra_link_share", "1", 0.0, 1.0),
        Quantity("extra_motor_share", "1", 0.0, 1.0),
    )


class QuadraticGear(_Loaded):
    """M6: M5 with the square of the torque that goes through the gear."""

    name = "quadratic_gear_friction"
    quantities = (*DirectionalGear.quantities, Quantity("extra_square", "1/(N m)", 0.0))
