"""The effect external force: a body is pushed from outside for some time."""

from typing import TYPE_CHECKING

from diagnosis.effects.bases import BodyEffect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.scales import weight_n
from diagnosis.effects.variants import Push
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant

_EARLIEST_S, _LONGEST_S = -2.0, 600.0
"""Bounds of a push: earliest start, in the recording's time, and longest duration. A
push may have begun before the recording."""


class ExternalForce(BodyEffect):
    """A constant force (x, y, z) at a body's centre of mass for some time.

    The force is in the world frame; `start` is in the recording's time. Its joint
    torques are J^T f, J the Jacobian of the centre of mass (Haddadin, De Luca and
    Albu-Schaffer 2017, "Robot collisions: a survey on detection, isolation, and
    identification").
    """

    name = "external_force"
    native = False
    components = 3
    timed = True
    at_tips = True
    rarity_nats = 3.0
    main_parameters = ("x", "y", "z")
    words = EffectWords(
        "push from outside",
        "{body} was pushed with {x} in x, {y} in y and {z} in z",
        "A hand, a cable or a collision pushes a body for some time.",
    )

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Force x, y, z [N], each up to the robot's weight; start and duration [s]."""
        weight = weight_n(plant)
        force = (Parameter(a, "N", -weight, weight, 0.0, 0.05 * weight) for a in "xyz")
        return (
            *force,
            Parameter("start", "s", _EARLIEST_S, _LONGEST_S, 0.0, 0.2),
            Parameter("duration", "s", 0.0, _LONGEST_S, 0.0, 0.2),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the push to one variant of the model; overlapping forces add up."""
        x, y, z, start_s, duration_s = (float(value) for value in values)
        if duration_s > 0 and any((x, y, z)):
            push = Push(place, (x, y, z), start_s, duration_s)
            variants.outside.pushes[row].append(push)
