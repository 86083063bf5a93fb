"""Something heavy that the model does not know of."""

from typing import TYPE_CHECKING

from diagnosis.effects.bases import BodyEffect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.scales import mass_kg
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class PayloadMass(BodyEffect):
    """A point of mass m at a body's centre of mass.

    The centre stays where it is, and so does the inertia about it: of m |r|^2 nothing
    is left at r = 0 (Featherstone 2008, "Rigid body dynamics algorithms", section
    2.13). In MuJoCo `body_mass`; constants that follow from it are `mj_setConst`'s.
    """

    name = "payload_mass"
    native = True
    by_inverse_dynamics = True
    words = EffectWords(
        "extra mass",
        "{body} carries {mass} {lacking}",
        "A load, a battery or a cable that the model does not know of.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The mass, up to the body's own or a third of the robot's."""
        own = float(plant.model.body(place).mass[0])
        high = max(own, 0.3 * mass_kg(plant))
        return (Parameter("mass", "kg", 0.0, high, 0.0, 0.2 * own),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Masses add."""
        variants.field("body_mass")[row, variants.body(place)] += values[0]
