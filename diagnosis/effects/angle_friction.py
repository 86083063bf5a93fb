"""Dry friction that is larger at some angles of a joint than at others."""

import numpy as np

from diagnosis.effects.base_kinds import JointEffect
from diagnosis.effects.parts import EffectWords, Parameter, PlacedEffect
from diagnosis.effects.scales import middle_rad, torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from groundwalk.arrays import FloatArray

GROWN_FACTORS = (0.6, 1.7)
"""Factors a radian that are tried once plain dry friction was found to help."""


class AngleFriction(JointEffect):
    """Torque -tau f^(q - m) sign(v): dry friction by the angle q, m its range's middle.

    It changes by the same factor f for each rad, so that it is never below zero. That
    is no law of physics, but the simplest form of one that grows or falls: linkages
    whose ratio changes with the angle, cables that bend, seals and shafts out of true.

    Source: friction maps over position of Armstrong-Helouvry 1991, "Control of machines
    with friction"; the calves of a real Go2 in the air, of which three rub about twice
    as hard at one end of their motion as at the other.
    """

    name = "angle_friction"
    shown_by = "poses"
    native = False
    only_grown = True
    of_motor = False
    main_parameters = ("torque",)
    words = EffectWords(
        "dry friction that varies with the angle",
        "{joint} has dry friction of {torque} in the middle of its range, {factor} "
        "times as much a radian (a metre, if it slides) further, {lacking}",
        "A linkage, a cable or a bent shaft rubs harder at one end of the motion than "
        "at the other.",
        "Turn the joint by hand over its range: look at cables, seals and linkages "
        "where it is stiff.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The torque tau [N m] in the middle, and the factor f for each rad."""
        scale = torque_nm(plant, place)
        return (
            Parameter("torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),
            Parameter("factor", "1", 0.02, 50.0, 1.0, 1.7, logarithmic=True),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Add the friction to one variant."""
        joints, at = copies.joints, (row, copies.column(place))
        torque, factor = values
        joints.coulomb_nm[at] += torque
        joints.angle_nm[at] += torque
        joints.angle_log_1_rad[at] = np.log(factor)
        joints.angle_from_rad[at] = middle_rad(copies.plant, place)

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Friction that changes with the angle, after dry friction that does not."""
        if other.name != "coulomb_friction":
            return ()
        (torque,) = other.values
        return tuple(
            PlacedEffect(self.name, other.place, (torque, factor))
            for factor in GROWN_FACTORS
        )

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Dry friction that is the same at all angles."""
        return (PlacedEffect("coulomb_friction", placed.place, placed.values[:1]),)

    def native_part(self, placed: PlacedEffect) -> PlacedEffect:
        """Dry friction as it is in the middle of the range."""
        return PlacedEffect("coulomb_friction", placed.place, placed.values[:1])
