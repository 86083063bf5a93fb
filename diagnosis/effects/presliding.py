"""Friction that acts as springs before it slides."""

from diagnosis.effects.base_kinds import JointEffect
from diagnosis.effects.parts import EffectWords, Parameter, Values
from diagnosis.effects.scales import torque_nm
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.usage import Usage
from diagnosis.verdict import PlacedEffect
from groundwalk.arrays import FloatArray

GROWN_REACHES_RAD = (0.002, 0.01, 0.05)
"""Reaches that are tried once plain dry friction was found to help. From bearings, 1e-4
rad, to geared servos, 0.1 rad, none is further from one of them than a fit goes."""


class Presliding(JointEffect):
    """Dry friction whose contacts bend like springs until, one by one, they slip.

    Eight springs of one stiffness in parallel slip at 1/8, 2/8 ... of the `reach`; the
    `torque` is that of long sliding. After each turn the torque goes over from one side
    to the other on a way of twice the reach: it depends on where the joint turned, and
    not on its speed. With a reach of 0 it is Coulomb's friction.

    Source: Maxwell slip in Lampaert, Al-Bender and Swevers 2003, "A generalized
    Maxwell-slip friction model appropriate for control purposes", without Stribeck's
    part. Their reaches are 1e-5 to 1e-3 rad; those of geared servos 1e-3 to 0.1 rad.
    """

    name = "presliding"
    native = False
    main_parameters = ("torque",)
    shown_by = "reversals"
    words = EffectWords(
        "friction that bends first (presliding)",
        "{joint} has dry friction of {torque} that bends for {reach} before it slides, "
        "{lacking}",
        "Teeth, seals and grease give way like springs after each reversal before they "
        "slide, so that small motions meet a spring and large ones dry friction.",
        "Gears of cheap servos do this; a stiffer gear or fresh grease shortens the "
        "way.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Torque of long sliding [N m], at most half of a large one; reach [rad]."""
        scale = torque_nm(plant, place)
        return (
            Parameter("torque", "N m", 0.0, 0.5 * scale, 0.0, 0.05 * scale),
            Parameter("reach", "rad", 1e-4, 0.5, 0.01, 0.01, logarithmic=True),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Add the friction to one variant; reaches are averaged by torque."""
        torque, reach = values
        if torque == 0:
            return
        joints, at = copies.joints, (row, copies.column(place))
        total = joints.slip_nm[at] + torque
        share = torque / total
        joints.slip_rad[at] = (1 - share) * joints.slip_rad[at] + share * reach
        joints.slip_nm[at] = total

    def first_tries(self, plant: Plant, place: str, usage: Usage) -> list[Values]:
        """None: it is tried where dry friction, which it ends as, helps."""
        return []

    def grown_from(self, other: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Presliding friction to try after dry friction: as large, some reaches."""
        if other.name != "coulomb_friction":
            return ()
        (torque,) = other.values
        return tuple(
            PlacedEffect(self.name, other.place, (torque, reach))
            for reach in GROWN_REACHES_RAD
        )

    def simpler(self, placed: PlacedEffect) -> tuple[PlacedEffect, ...]:
        """Dry friction that slides at once."""
        return (PlacedEffect("coulomb_friction", placed.place, placed.values[:1]),)
