"""The effect drag: water, air or a trailing cable slows a body down."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from diagnosis.effects.bases import BodyEffect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.scales import weight_n
from groundwalk.arrays import FloatArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace


class Drag(BodyEffect):
    """Force -c v at a body's centre of mass, with v the velocity of that point.

    Source: drag at low speed, linear as Stokes 1851 found for a sphere.
    """

    name = "drag"
    native = False
    at_tips = True
    rarity_nats = 3.0
    words = EffectWords(
        "drag",
        "{body} meets a drag of {coefficient} {lacking}",
        "A force against the body's velocity, as of air, water or a trailing cable.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """Names of bodies that move, except those that only slide along one line.

        Drag of those is the same as viscous friction of their sliding joint.
        """
        every = super().places(plant, traces)
        return tuple(name for name in every if not _slides(plant, name))

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """The coefficient c [N s/m], typically 10 % of the robot's weight at 1 m/s."""
        scale = weight_n(plant)
        return (Parameter("coefficient", "N s/m", 0.0, 2 * scale, 0.0, 0.1 * scale),)

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Add the coefficient to a body's drag in one variant of the model."""
        variants.outside.drag_n_s_m[row, variants.body(place)] += values[0]


def _slides(plant: "Plant", name: str) -> bool:
    """Whether a body can only slide along one line."""
    import mujoco

    model = plant.model
    body = int(model.body(name).id)
    joints = []
    while body > 0:
        first = int(model.body_jntadr[body])
        joints += list(model.jnt_type[first : first + int(model.body_jntnum[body])])
        body = int(model.body_parentid[body])
    return joints == [mujoco.mjtJoint.mjJNT_SLIDE.value]
