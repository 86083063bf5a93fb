"""The effect com offset: a body's centre of mass is not where the model has it."""

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
"""MuJoCo's `body_simple` for a simple body that can rotate; 2 is for one that only
slides."""


class ComOffset(BodyEffect):
    """The centre of mass is shifted by (x, y, z) in the body's frame.

    Mass and inertia about the centre stay as they are.

    Source: first moments among the inertial parameters, Atkeson, An and Hollerbach
    1986, "Estimation of inertial parameters of manipulator loads and links". In MuJoCo
    `body_ipos`.
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
        """Names of bodies, except those that MuJoCo's compiler has made simple.

        A simple body rotates about its centre of mass, so MuJoCo's mass matrix has no
        entries for the coupling that an offset causes. `simple="false"` in the model
        avoids this.
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
        """The offset [m] along each axis of the body's frame."""
        return tuple(Parameter(axis, "m", -0.1, 0.1, 0.0, 0.01) for axis in "xyz")

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Shift a body's centre of mass in one variant of the model."""
        variants.field("body_ipos")[row, variants.body(place)] += values
