"""A centre of mass that is not where the model has it."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from diagnosis.effects.bases import BodyEffect
from diagnosis.effects.parts import EffectWords, Parameter
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace

_ABOUT_ITS_CENTRE = 1
"""`body_simple` of simple bodies that turn; those that only slide have 2."""


class ComOffset(BodyEffect):
    """Centre of mass + (x, y, z) in the body's frame; mass and central inertia stay.

    Source: first moments among the inertial parameters, Atkeson, An and Hollerbach
    1986, "Estimation of inertial parameters of manipulator loads and links". In MuJoCo
    `body_ipos`; constants that follow from it are `mj_setConst`'s.
    """

    name = "com_offset"
    native = True
    components = 3
    by_inverse_dynamics = True
    rarity_nats = 1.0
    words = EffectWords(
        "shifted centre of mass",
        "the centre of mass of {body} is shifted from its place {usual} by {x} in x, "
        "{y} in y and {z} in z",
        "The mass is right, but sits elsewhere in the body.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Bodies, less those that the compiler made simple; `simple="false"` helps.

        Such a body turns about its centre of mass, and MuJoCo leaves no room in the
        mass matrix for what an offset would couple.
        """
        places = super().places(plant, traces)
        simple = [
            plant.model.body(name).simple[0] == _ABOUT_ITS_CENTRE for name in places
        ]
        return tuple(
            name
            for name, is_simple in zip(places, simple, strict=True)
            if not is_simple
        )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """One number an axis."""
        return tuple(Parameter(axis, "m", -0.1, 0.1, 0.0, 0.01) for axis in "xyz")

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Offsets add."""
        variants.field("body_ipos")[row, variants.body(place)] += values
