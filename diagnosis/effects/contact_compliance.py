"""An effect: soles or ground are soft."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from diagnosis.effects.effect import Effect
from diagnosis.effects.ground import foot_geoms, has_ground_contact
from diagnosis.effects.parts import EffectWords, Parameter, PlaceKind
from diagnosis.effects.scales import mass_kg, weight_n
from groundwalk.arrays import FloatArray, IntArray

if TYPE_CHECKING:
    from diagnosis.effects.variants import Variants
    from diagnosis.plant.plant import Plant
    from diagnosis.traces.trace import Trace

DAMPING_RATIO = 0.1
"""Damping as a share of critical damping, for the whole robot on one foot."""

_ADDED_MASS = 0.25
"""Mass that the soft contact seems to have, as a share of the foot's effective mass."""

_IMPEDANCE_RATIO = 100.0
"""Tangential over normal impedance, so that a sticking foot hardly creeps."""

_WEIGHT_OVER_GROUND = 1e9
"""Weight of the foot's solver parameters against those of the ground."""


class ContactCompliance(Effect):
    """Soft contact of a flat foot: normal force K r + B r' at depth r.

    Source: Kelvin-Voigt contact as in Gilardi and Sharf 2002, "Literature survey of
    contact dynamics modelling", section 4. B is a tenth of critical damping.

    In MuJoCo (documentation, "Constraint model" and "Reference") a contact with solref
    (-k, -b) and constant impedance d solves a + b r' / d + k r / d + R f = 0, with
    R = A (1 - d) / d and A the foot's inverse mass in the reference pose
    (`body_invweight0`). At rest f = k r / (A (1 - d)): k is per effective mass, and
    K [N/m] of a foot with n contact points takes k = K A (1 - d) / n, likewise b. What
    differs from a spring is the mass n / R that the contact seems to have; d is
    chosen so that it is a quarter of the foot's, 1 / A.

    A sticking foot creeps at tangential force / B; an elliptic cone with its tangential
    impedance raised a hundredfold slows that to a hundredth.

    K is that of the plant: where a row's masses differ, it changes with A. Of two geoms
    the one with the higher priority decides; the feet's must not be the lower one.
    """

    name = "contact_compliance"
    place_kind: ClassVar[PlaceKind] = "feet"
    native = True
    main_parameters = ("stiffness",)
    words = EffectWords(
        "soft ground",
        "the ground gives way under each foot with a stiffness of {stiffness} "
        "{lacking}",
        "Carpet, grass or rubber soles: the feet sink in and come back late.",
    )

    def places(self, plant: "Plant", traces: Sequence["Trace"]) -> tuple[str, ...]:
        """The feet, if they can touch a ground."""
        return ("feet",) if has_ground_contact(plant) else ()

    def parameters(self, plant: "Plant", place: str) -> tuple[Parameter, ...]:
        """Stiffness K of one foot, on which the robot sinks in by 0.1 to 30 mm."""
        weight = weight_n(plant)
        return (
            Parameter(
                "stiffness",
                "N/m",
                weight / 0.03,
                weight / 1e-4,
                np.inf,
                weight / 4e-3,
                logarithmic=True,
            ),
        )

    def apply(
        self, variants: "Variants", row: int, place: str, values: FloatArray
    ) -> None:
        """Make all feet soft, in series with feet that an effect made soft before."""
        import mujoco

        stiffness = values[0]
        if np.isinf(stiffness):
            return
        for foot in variants.plant.feet:
            _soften(variants, row, foot, stiffness)
        variants.field("opt.cone")[row] = mujoco.mjtCone.mjCONE_ELLIPTIC
        ratio = variants.field("opt.impratio")
        ratio[row] = np.maximum(ratio[row], _IMPEDANCE_RATIO)


def _soften(variants: "Variants", row: int, foot: str, stiffness: float) -> None:
    """Give one foot a stiffness [N/m], in series with one that it was given before."""
    plant = variants.plant
    geoms = foot_geoms(plant, foot)
    points = _contact_points(plant, geoms)
    if points == 0:
        return
    impedance = _ADDED_MASS / (points + _ADDED_MASS)
    inverse_mass = float(plant.model.body_invweight0[variants.body(foot), 0])
    scale = inverse_mass * (1 - impedance) / points
    reference = variants.field("geom_solref")
    mix = variants.field("geom_solmix")
    if mix[row, geoms[0]] == _WEIGHT_OVER_GROUND:
        stiffness = 1 / (1 / stiffness - scale / reference[row, geoms[0], 0])
    damping = 2 * DAMPING_RATIO * np.sqrt(stiffness * mass_kg(plant))
    reference[row, geoms] = -scale * stiffness, -scale * damping
    variants.field("geom_solimp")[row, geoms, :2] = impedance
    mix[row, geoms] = _WEIGHT_OVER_GROUND


def _contact_points(plant: "Plant", geoms: IntArray) -> int:
    """Number of contacts that MuJoCo 4.0 finds between flat geoms and a plane."""
    import mujoco

    kind = mujoco.mjtGeom
    points = {
        int(kind.mjGEOM_SPHERE): 1,
        int(kind.mjGEOM_ELLIPSOID): 1,
        int(kind.mjGEOM_CAPSULE): 2,
        int(kind.mjGEOM_CYLINDER): 3,
        int(kind.mjGEOM_BOX): 4,
        int(kind.mjGEOM_MESH): 4,
    }
    return sum(points.get(int(plant.model.geom_type[geom]), 1) for geom in geoms)
