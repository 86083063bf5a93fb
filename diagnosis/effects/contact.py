"""Effects of the contact between feet and ground: friction and softness."""

from collections.abc import Sequence

import mujoco
import numpy as np

from diagnosis.effects.effect import Effect
from diagnosis.effects.ground import (
    foot_geoms,
    ground_geoms,
    has_ground_contact,
    sole_friction,
    sole_geoms,
)
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.scales import mass_kg, weight_n
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray

DAMPING_RATIO = 0.1
"""Damping of soft contact as a share of critical damping of the robot on one foot."""

_ADDED_MASS = 0.25
"""Apparent mass of MuJoCo's soft contact as a share of the foot's effective mass, small
so that the contact acts like a spring and damper without mass."""

_IMPEDANCE_RATIO = 100.0
"""MuJoCo's `impratio`, tangential over normal impedance of contacts: large, so that a
sticking foot hardly creeps."""

_WEIGHT_OVER_GROUND = 1e9
"""MuJoCo's `solmix` of a soft foot: so large that the foot's solver parameters count in
a contact instead of the ground's."""


class ContactFriction(Effect):
    """Friction of feet on the ground: tangential force <= mu times normal force.

    Source: Coulomb friction as in Stewart and Trinkle 1996, "An implicit time-stepping
    scheme for rigid body dynamics with inelastic collisions and Coulomb friction". In
    MuJoCo `geom_friction`; friction of explicit contact pairs is not changed.
    """

    name = "contact_friction"
    place_kind = "feet"
    native = True
    words = EffectWords(
        "another grip of the ground",
        "the friction coefficient between feet and ground is {coefficient}, unlike "
        "{usual}",
        "The feet slip earlier, or later, than they should.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("feet",) if the feet can touch a ground and have friction on it, else ()."""
        walks = has_ground_contact(plant) and sole_friction(plant) > 0
        return ("feet",) if walks else ()

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The coefficient mu; two thirds of the model's is tried first."""
        nominal = sole_friction(plant)
        high = max(2.0, 2 * nominal)
        return (
            Parameter("coefficient", "1", 0.02, high, nominal, nominal * 2 / 3, True),
        )

    def apply(
        self, variants: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Scale the coefficients of feet and ground in one variant by the same factor.

        MuJoCo uses the larger coefficient of two geoms, or that of the geom with higher
        priority; scaling both gives mu in either case.
        """
        plant = variants.plant
        geoms = np.concatenate([ground_geoms(plant), sole_geoms(plant)])
        factor = values[0] / sole_friction(plant)
        variants.field("geom_friction")[row, geoms, 0] *= factor


class ContactCompliance(Effect):
    """Soft contact of a flat foot: normal force K r + B r' [N] at depth r [m].

    Source: Kelvin-Voigt contact as in Gilardi and Sharf 2002, "Literature survey of
    contact dynamics modelling", section 4. B is a tenth of critical damping.

    In MuJoCo (documentation, "Constraint model" and "Reference") a contact with solref
    (-k, -b) and constant impedance d solves a + b r' / d + k r / d + R f = 0, with
    acceleration a, force f, R = A (1 - d) / d, and A the foot's inverse mass in the
    reference pose (`body_invweight0`). At rest f = k r / (A (1 - d)). So a foot with n
    contact points gets stiffness K by k = K A (1 - d) / n, and likewise B. Unlike a
    spring the contact has an apparent mass n / R; d makes it a quarter of the foot's
    effective mass 1 / A.

    A sticking foot creeps at tangential force / B; an elliptic friction cone and
    `impratio` 100 slow that to a hundredth.

    Limits: if another effect changes masses, K changes with A. The feet's geoms must
    not have a lower priority than the ground's, or MuJoCo ignores their softness.
    """

    name = "contact_compliance"
    place_kind = "feet"
    native = True
    main_parameters = ("stiffness",)
    words = EffectWords(
        "soft ground",
        "the ground gives way under each foot with a stiffness of {stiffness} "
        "{lacking}",
        "Carpet, grass or rubber soles: the feet sink in and come back late.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("feet",) if the model's feet can touch a ground, else ()."""
        return ("feet",) if has_ground_contact(plant) else ()

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Stiffness K of one foot [N/m], on which the robot sinks by 0.1 to 30 mm."""
        weight = weight_n(plant)
        low, typical, high = (weight / sinks_m for sinks_m in (0.03, 4e-3, 1e-4))
        return (Parameter("stiffness", "N/m", low, high, np.inf, typical, True),)

    def apply(
        self, variants: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Make all feet of a variant soft, in series with any softness given before."""
        stiffness = values[0]
        if np.isinf(stiffness):
            return
        for foot in variants.plant.feet:
            _soften(variants, row, foot, stiffness)
        variants.field("opt.cone")[row] = mujoco.mjtCone.mjCONE_ELLIPTIC
        ratio = variants.field("opt.impratio")
        ratio[row] = np.maximum(ratio[row], _IMPEDANCE_RATIO)


def _soften(variants: Variants, row: int, foot: str, stiffness: float) -> None:
    """Give one foot a stiffness [N/m], in series with any that it was given before."""
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


def _contact_points(plant: Plant, geoms: IntArray) -> int:
    """Number of contacts that MuJoCo 4.0 makes between geoms lying flat and a plane."""
    kind = mujoco.mjtGeom
    points = {  # other shapes, such as spheres, touch at one point
        int(kind.mjGEOM_CAPSULE): 2,
        int(kind.mjGEOM_CYLINDER): 3,
        int(kind.mjGEOM_BOX): 4,
        int(kind.mjGEOM_MESH): 4,
    }
    return sum(points.get(int(plant.model.geom_type[geom]), 1) for geom in geoms)
