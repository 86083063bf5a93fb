"""Dry friction of servo gears by load and speed: the upper rungs of a ladder.

The ladder is that of Duclusaud, Passault, Padois and Ly 2024, "Extended friction models
for the physics simulation of servo actuators" (arXiv 2410.08650): M1 is dry and viscous
friction, M2 has a Stribeck peak, M3 grows with load, M4 does both, M5 tells the motor's
side of the gear from the links' side, M6 has a quadratic term. All have the form of
`replay.dry_friction.DryFriction`; viscous friction is an effect of its own. No rung is
tried on its own: each grows from one below it where that was found to help.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar

from diagnosis.effects.base_kinds import JointEffect
from diagnosis.effects.friction import GROWN_SPEEDS_RAD_S, add_peak
from diagnosis.effects.parts import EffectWords, Parameter, PlacedEffect
from diagnosis.effects.places import driven_joints
from diagnosis.effects.scales import torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

QUANTITIES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "coulomb_torque": ("coulomb_nm",),
        "share": ("link_share", "load_share"),
        "link_share": ("link_share",),
        "motor_share": ("load_share",),
        "extra_share": ("extra_link_share", "extra_load_share"),
        "extra_link_share": ("extra_link_share",),
        "extra_motor_share": ("extra_load_share",),
        "extra_square": ("extra_square_1_nm",),
    }
)
"""Attributes of `Joints` to which a parameter's value is added."""

GROWN_SHARE, GROWN_SQUARE_1_NM = 0.05, 0.01
"""Share of torques, and square term [1/(N m)], to start from where a rung below has
none: the middle of the published sizes, and the largest of the latter."""

GROWN_EXPONENTS = (1.2, 4.0)
"""Stribeck exponents a to start from beside a = 2: about the ends of the published
ones, except for those so large that the drop is as good as a step."""

SLOW_PART = 0.5
"""Part of dry friction that is more near standstill, to start from."""


class GearRung(JointEffect):
    """A rung of the ladder: its parameters say which terms of the law it has."""

    native = False
    only_grown = True
    on_ladder: ClassVar[tuple[str, ...]]
    """Names of the rung's parameters, in order."""

    @property
    def by_load(self) -> bool:
        """Whether the friction depends on the load of the gear."""
        return any("share" in name for name in self.on_ladder)

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The rung's torques [N m], shares, speed [rad/s], exponent and square term."""
        known = _all_parameters(torque_nm(plant, place))
        return tuple(known[name] for name in self.on_ladder)

    def native_part(self, placed: PlacedEffect) -> PlacedEffect:
        """Dry friction that is the same at all speeds and loads."""
        return PlacedEffect("coulomb_friction", placed.place, placed.values[:1])

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """All joints; by load those with motors, on a fixed base.

        Of a robot on its feet the ground loads the gears as well, which the law does
        not know of.
        """
        if not self.by_load:
            return super().places(plant, traces)
        return driven_joints(plant, traces) if plant.base == "fixed" else ()

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Add the friction's terms to one variant."""
        joints, at = copies.joints, (row, copies.column(place))
        by_name = dict(zip(self.on_ladder, values, strict=True))
        if "speed" in by_name:
            peak = (by_name.pop(name) for name in ("extra_torque", "speed", "exponent"))
            add_peak(joints, at, *peak)
        for name, value in by_name.items():
            for quantity in QUANTITIES[name]:
                vars(joints)[quantity][at] += value


class ShapedStribeck(GearRung):
    """Torque -(t_c + t_s exp(-|v / v_s|^a)) sign(v): M2 with its exponent a free.

    Source: see the module; the exponent also in Armstrong-Helouvry, Dupont and Canudas
    de Wit 1994, section 2.
    """

    name = "shaped_stribeck_friction"
    shown_by = "speeds"
    on_ladder = ("coulomb_torque", "extra_torque", "speed", "exponent")
    main_parameters = ("coulomb_torque", "extra_torque")
    words = EffectWords(
        "dry friction that sticks, shape free",
        "{joint} has dry friction of {coulomb_torque}, and {extra_torque} more below "
        "{speed}, from where it drops with exponent {exponent}, {lacking}",
        "Dry friction that is larger near standstill, and drops with speed more or "
        "less abruptly.",
        "Grease the gear or the bearing; move in and out of rest less often.",
    )

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Friction with a peak of exponent 2, with more and less abrupt peaks."""
        if other.name != "stribeck_friction":
            return ()
        return tuple(
            PlacedEffect(self.name, other.place, (*other.values, exponent))
            for exponent in GROWN_EXPONENTS
        )

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """The peak with exponent 2."""
        return (PlacedEffect("stribeck_friction", placed.place, placed.values[:3]),)


class LoadedGear(GearRung):
    """Torque -(t_c + k |L - T|) sign(v): M3, with T and L of motor and links."""

    name = "gear_friction"
    shown_by = "poses"
    scales_servo = True
    on_ladder = ("coulomb_torque", "share")
    words = EffectWords(
        "friction of loaded gears",
        "{joint} has dry friction of {coulomb_torque}, and {share} of the torques that "
        "press on its gear from both sides, {lacking}",
        "Gears rub harder the more the motor and the links press on them.",
        "Grease the gear or replace it; carry less, or balance the link.",
    )

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Friction of loaded gears, after dry friction or friction by servo torque.

        Where motor and links hold each other, the torques of both sides are equal.
        """
        if other.name == "coulomb_friction":
            values = (other.values[0] / 2, GROWN_SHARE)
        elif other.name == "load_friction":
            values = (0.0, other.values[0] / 2)
        else:
            return ()
        return (PlacedEffect(self.name, other.place, values),)

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Dry friction alone; friction by the servo's torque, which is nearly in it."""
        torque, share = placed.values
        return (
            PlacedEffect("load_friction", placed.place, (2 * share,)),
            PlacedEffect("coulomb_friction", placed.place, (torque,)),
        )


class LoadedStribeck(GearRung):
    """Torque -(t_c + k |L - T| + exp(-|v / v_s|^a) (t_s + k_s |L - T|)) sign(v): M4."""

    name = "gear_stribeck_friction"
    shown_by = "poses"
    scales_servo = True
    on_ladder = (*ShapedStribeck.on_ladder, "share", "extra_share")
    main_parameters = ("coulomb_torque", "extra_torque", "share", "extra_share")
    words = EffectWords(
        "sticking friction of loaded gears",
        "{joint} has dry friction of {coulomb_torque} and {share} of the torques that "
        "press on its gear, and {extra_torque} and {extra_share} of them more below "
        "{speed} (exponent {exponent}), {lacking}",
        "Gears rub harder the more motor and links press on them, most of all near "
        "standstill.",
        "Grease the gear or replace it; carry less, or balance the link.",
    )

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Loaded gears with a peak, after friction with a peak or by load alone.

        The latter may be that by the servo's torque: where the motor's share is the
        larger one, a common share alone need not be better than none of the links'.
        """
        if other.name in ("stribeck_friction", ShapedStribeck.name):
            torque, extra, speed, *shape = other.values
            exponent = shape[0] if shape else 2.0
            some = [(torque, extra, speed, exponent, GROWN_SHARE, GROWN_SHARE)]
        elif other.name in (LoadedGear.name, "load_friction"):
            *rest, share = other.values
            torque = rest[0] if rest else 0.0
            share = share if rest else share / 2
            slow = SLOW_PART * torque, SLOW_PART * share
            some = [
                (torque, slow[0], speed, 2.0, share, slow[1])
                for speed in GROWN_SPEEDS_RAD_S
            ]
        else:
            return ()
        return tuple(PlacedEffect(self.name, other.place, one) for one in some)

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Friction with a peak alone, and friction by load alone."""
        torque, extra, speed, exponent, share, _ = placed.values
        peak = torque, extra, speed, exponent
        return (
            PlacedEffect(ShapedStribeck.name, placed.place, peak),
            PlacedEffect("stribeck_friction", placed.place, peak[:3]),
            PlacedEffect(LoadedGear.name, placed.place, (torque, share)),
        )


class DirectionalGear(GearRung):
    """M5: M4 with a share of each side, |k_L L - k_T T| and |e_L L - e_T T|."""

    name = "directional_gear_friction"
    shown_by = "poses"
    scales_servo = True
    on_ladder = (
        *ShapedStribeck.on_ladder,
        *("link_share", "motor_share", "extra_link_share", "extra_motor_share"),
    )
    main_parameters = ("coulomb_torque", *on_ladder[4:])
    words = EffectWords(
        "gears that rub by side of the load",
        "{joint} has dry friction of {coulomb_torque}, {link_share} of its links' and "
        "{motor_share} of its motor's torque, and below {speed} (exponent {exponent}) "
        "{extra_torque}, {extra_link_share} and {extra_motor_share} of them more, "
        "{lacking}",
        "Gears rub by the load on them, with one share of the motor's torque and "
        "another of the links': driven backwards they rub in another way.",
        "Grease the gear or replace it; carry less, or balance the link.",
    )

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Gears with a share of each side, after one share, which both start from."""
        if other.name != LoadedStribeck.name:
            return ()
        *peak, share, extra = other.values
        values = (*peak, share, share, extra, extra)
        return (PlacedEffect(self.name, other.place, values),)

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Friction by load with the mean shares."""
        peak, shares = placed.values[:4], placed.values[4:]
        means = (sum(shares[:2]) / 2, sum(shares[2:]) / 2)
        return (PlacedEffect(LoadedStribeck.name, placed.place, (*peak, *means)),)


class QuadraticGear(GearRung):
    """M6, which is M5 with q P^2 beside t_s near standstill.

    P is the smaller one of the torques of motor and links, where they are opposed; the
    published program has a q for each of the two ways, one stands for both here.

    Source: see the module.
    """

    name = "quadratic_gear_friction"
    shown_by = "poses"
    scales_servo = True
    on_ladder = (*DirectionalGear.on_ladder, "extra_square")
    main_parameters = (*DirectionalGear.main_parameters, "extra_square")
    words = EffectWords(
        "gears that rub by the load's square",
        "{joint} has dry friction of {coulomb_torque}, {link_share} of its links' and "
        "{motor_share} of its motor's torque, and below {speed} (exponent {exponent}) "
        "{extra_torque}, {extra_link_share} and {extra_motor_share} of them and "
        "{extra_square} of the square of the torque between them more, {lacking}",
        "Gears rub by the load on them, near standstill also by its square.",
        "Grease the gear or replace it; carry less, or balance the link.",
    )

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Gears with a square term, after the same friction without it."""
        if other.name != DirectionalGear.name:
            return ()
        values = (*other.values, GROWN_SQUARE_1_NM)
        return (PlacedEffect(self.name, other.place, values),)

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Gears that rub by side of the load, without a square term."""
        return (PlacedEffect(DirectionalGear.name, placed.place, placed.values[:-1]),)


def _all_parameters(large_nm: float) -> dict[str, Parameter]:
    """All parameters of the ladder by name, for a joint with this large torque [N m].

    Bounds of shares and exponent are the published ones; others as for other friction.
    """
    every = [
        Parameter("coulomb_torque", "N m", 0.0, 0.5 * large_nm, 0.0, 0.05 * large_nm),
        Parameter("extra_torque", "N m", 0.0, 0.5 * large_nm, 0.0, 0.04 * large_nm),
        Parameter("speed", "rad/s", 0.005, 2.0, 0.1, 0.1, logarithmic=True),
        Parameter("exponent", "1", 1.0, 10.0, 2.0, 2.0, logarithmic=True),
        Parameter("extra_square", "1/(N m)", 0.0, 0.5 / large_nm, 0.0, 0.05 / large_nm),
    ]
    for name in ("share", "link_share", "motor_share"):
        every.append(Parameter(name, "1", 0.0, 0.5, 0.0, GROWN_SHARE))
        every.append(Parameter(f"extra_{name}", "1", 0.0, 1.0, 0.0, GROWN_SHARE))
    return {one.name: one for one in every}
