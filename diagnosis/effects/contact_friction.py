"""The effect contact friction: feet on the ground have another friction coefficient."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from diagnosis.effects.effect import Effect
from diagnosis.effects.ground import (
    ground_geoms,
    has_ground_contact,
    sole_friction,
    sole_geoms,
)
from diagnosis.effects.parts import EffectWords, Parameter, PlaceKind
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class ContactFriction(Effect):
    """Friction of feet on the ground: tangential force <= mu times normal force.

    Source: Coulomb friction as in Stewart and Trinkle 1996, "An implicit time-stepping
    scheme for rigid body dynamics with inelastic collisions and Coulomb friction". In
    MuJoCo `geom_friction`; friction of explicit contact pairs is not changed.
    """

    name = "contact_friction"
    place_kind: ClassVar[PlaceKind] = "feet"
    native = True
    words = EffectWords(
        "another grip of the ground",
        "the friction coefficient between feet and ground is {coefficient}, unlike "
        "{usual}",
        "The feet slip earlier, or later, than they should.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """("feet",) if the feet can touch a ground and have friction on it, else ()."""
        walks = has_ground_contact(plant) and sole_friction(plant) > 0
        return ("feet",) if walks else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The coefficient mu; two thirds of the model's is tried first."""
        nominal = sole_friction(plant)
        high = max(2.0, 2 * nominal)
        return (
            Parameter("coefficient", "1", 0.02, high, nominal, nominal * 2 / 3, True),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Scale the coefficients of feet and ground in one variant by the same factor.

        MuJoCo uses the larger coefficient of two geoms, or that of the geom with higher
        priority; scaling both gives mu in either case.
        """
        plant = variants.plant
        geoms = np.concatenate([ground_geoms(plant), sole_geoms(plant)])
        factor = values[0] / sole_friction(plant)
        variants.field("geom_friction")[row, geoms, 0] *= factor
