"""An effect: a body carries mass that the model does not have."""

from typing import TYPE_CHECKING

from diagnosis.effects.bases import BodyEffect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.scales import mass_kg
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant


class PayloadMass(BodyEffect):
    """A point mass m at a body's centre of mass.

    Centre of mass and inertia about it stay as they are, since a point mass at distance
    r adds m r^2 (Featherstone 2008, "Rigid body dynamics algorithms", section 2.13). In
    MuJoCo `body_mass`.
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
        """The mass [kg], up to the body's own or 30 % of the robot's if larger."""
        own = float(plant.model.body(place).mass[0])
        high = max(own, 0.3 * mass_kg(plant))
        return (Parameter("mass", "kg", 0.0, high, 0.0, 0.2 * own),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the payload to a body's mass in one variant of the model."""
        variants.field("body_mass")[row, variants.body(place)] += values[0]
