"""Effects of the ground under the feet: slope, bumps, friction and softness."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from diagnosis.effects.base_kinds import NumberEffect
from diagnosis.effects.effect import Effect
from diagnosis.effects.parts import EffectWords, Parameter
from diagnosis.effects.scales import mass_kg, weight_n
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Base, Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadModelError


def ground_geoms(plant: Plant) -> IntArray:
    """(k,) MuJoCo ids of the geoms on the world body that can collide: the ground."""
    model = plant.model
    can_touch = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
    return np.flatnonzero((model.geom_bodyid == 0) & can_touch)


def foot_geoms(plant: Plant, foot: str) -> IntArray:
    """(k,) MuJoCo ids of a foot's geoms that can collide with the ground."""
    model = plant.model
    of_foot: IntArray = np.flatnonzero(model.geom_bodyid == model.body(foot).id)
    ground = ground_geoms(plant)
    type_foot, like_foot = model.geom_contype[of_foot], model.geom_conaffinity[of_foot]
    meets = (type_foot[:, None] & model.geom_conaffinity[ground]) | (
        like_foot[:, None] & model.geom_contype[ground]
    )
    touching: IntArray = of_foot[(meets != 0).any(axis=1)]
    return touching


def sole_geoms(plant: Plant) -> IntArray:
    """(k,) MuJoCo ids of the geoms of all feet that can collide with the ground."""
    none = np.zeros(0, np.intp)
    return np.concatenate([none, *(foot_geoms(plant, foot) for foot in plant.feet)])


def has_ground_contact(plant: Plant) -> bool:
    """Whether the base floats and the robot has feet that can touch a ground."""
    return plant.base == "floating" and len(sole_geoms(plant)) > 0


def sole_friction(plant: Plant) -> float:
    """Sliding friction coefficient of the feet on the ground; 0 if they cannot touch.

    MuJoCo uses the coefficient of the geom with the higher priority, and the larger one
    if priorities are equal (its documentation, "Contact parameters").
    """
    model, ground, soles = plant.model, ground_geoms(plant), sole_geoms(plant)
    if not len(soles):
        return 0.0
    sole, floor = int(soles[0]), int(ground[0])
    friction = model.geom_friction[[sole, floor], 0]
    priority = model.geom_priority[[sole, floor]]
    if priority[0] == priority[1]:
        return float(friction.max())
    return float(friction[np.argmax(priority)])


class GroundSlope(Effect):
    """The ground, or a fixed base, is rotated by R = R_y(pitch) R_x(roll).

    With positive pitch the ground falls towards +x, with positive roll it rises towards
    +y. For a floating base the ground's geoms rotate about the world's origin. For a
    fixed base gravity g rotates instead: it becomes R^T g in the base's frame.

    Source: elementary rotations, Craig 2005, "Introduction to robotics", chapter 2. In
    MuJoCo `geom_quat` and `geom_pos`, or `opt.gravity`.
    """

    name = "ground_slope"
    shown_by = "poses"
    place_kind = "world"
    native = True
    components = 2
    by_inverse_dynamics = True
    words = EffectWords(
        "tilt",
        "the ground, or the mounting of the base, is tilted by {pitch} in pitch and "
        "{roll} in roll",
        "Gravity does not point where the model has it.",
        "Lay a spirit level on the ground or the robot's mount.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("world",) if the base is fixed or the model has a ground, else ()."""
        has_any = plant.base == "fixed" or len(ground_geoms(plant)) > 0
        return ("world",) if has_any else ()

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The parameters pitch and roll [rad] of the tilt."""
        return tuple(
            Parameter(name, "rad", -0.3, 0.3, 0.0, 0.03) for name in ("pitch", "roll")
        )

    def tolerance(self, plant: Plant, place: str) -> float:
        """2 mrad: how level a base is usually mounted."""
        return 2e-3

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Rotate a variant's ground, or its gravity if the base is fixed."""
        if not np.any(values):
            return
        if copies.plant.base == "fixed":
            self.apply_to_sim(copies, row, place, values)
            return
        tilt = _tilt(*values)
        places, turns = copies.field("geom_pos"), copies.field("geom_quat")
        for geom in ground_geoms(copies.plant):
            places[row, geom] = _call("mju_rotVecQuat", 3, places[row, geom], tilt)
            turns[row, geom] = _call("mju_mulQuat", 4, tilt, turns[row, geom])

    def apply_to_sim(
        self, copies: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Rotate gravity instead of the ground, so that heightfields stay in place."""
        gravity = copies.field("opt.gravity")
        back = _call("mju_negQuat", 4, _tilt(*values))
        gravity[row] = _call("mju_rotVecQuat", 3, gravity[row], back)

    def obstacle(self, recorded: Base, base: Base) -> str:
        """Why a floating base cannot have the tilt of a fixed one's mount, or ""."""
        if recorded != "fixed" or base != "floating":
            return ""
        return (
            "ground_slope is how a fixed base was mounted: a floating robot "
            "cannot have it"
        )


class UnevenGround(NumberEffect):
    """Bumps: heights of the ground spread about the plane, 99 % within +-height.

    Where the bumps are cannot be known: a simulation takes the ground to be where the
    recorded soles stood at its start (`diagnosis.replay.conforming_ground`). So the
    height found is about that of the largest bump stepped on, bumps below 0.6 mm are
    not seen, and the ground is flat where a foot steps later.

    Source: ground profiles as random processes, ISO 8608:2016.
    """

    name = "uneven_ground"
    place_kind = "world"
    native = False
    no_law = "it says how high bumps are, not where"
    rarity_nats = 10.0  # fits every stand of a sole, like a parameter for each
    quantity = "bump_height_m"
    usual = (Parameter("height", "m", 0.0, 0.03, 0.0, 0.001),)
    words = EffectWords(
        "uneven ground",
        "the ground has bumps of {height} {lacking}",
        "The feet meet the ground earlier or later than on a plane.",
        "Let the robot do the same on another floor.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("world",) if the robot can walk on a ground, else ()."""
        return ("world",) if has_ground_contact(plant) else ()

    def apply_to_sim(
        self, copies: Variants, row: int, place: str, values: FloatArray
    ) -> None:
        """Refuse the effect (`BadModelError`): nothing says where the bumps are."""
        raise BadModelError(
            "uneven_ground says how high bumps are, not where: give the sim a "
            "terrain with bumps instead"
        )


def _tilt(pitch_rad: float, roll_rad: float) -> FloatArray:
    """Quaternion (4,) w, x, y, z of the rotation R_y(pitch) R_x(roll)."""
    pitch = np.array([np.cos(pitch_rad / 2), 0, np.sin(pitch_rad / 2), 0])
    roll = np.array([np.cos(roll_rad / 2), np.sin(roll_rad / 2), 0, 0])
    return _call("mju_mulQuat", 4, pitch, roll)


def _call(function: str, size: int, *arguments: Any) -> FloatArray:
    """Call a function of MuJoCo by name; return the array (size,) that it writes."""
    result = np.zeros(size)
    getattr(mujoco, function)(result, *arguments)
    return result


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
        "Clean soles and floor.",
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

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Scale the coefficients of feet and ground in one variant by the same factor.

        MuJoCo uses the larger coefficient of two geoms, or that of the geom with higher
        priority; scaling both gives mu in either case.
        """
        plant = copies.plant
        geoms = np.concatenate([ground_geoms(plant), sole_geoms(plant)])
        factor = values[0] / sole_friction(plant)
        copies.field("geom_friction")[row, geoms, 0] *= factor


class ContactCompliance(Effect):
    """Soft contact of a flat foot: normal force K r + B r' [N] at depth r [m].

    Source: Kelvin-Voigt contact as in Gilardi and Sharf 2002, "Literature survey of
    contact dynamics modelling", section 4. B is a tenth of critical damping.

    In MuJoCo (documentation, "Constraint model" and "Reference") a contact with solref
    (-k, -b) and constant impedance d solves a + b r' / d + k r / d + R f = 0, with
    acceleration a, force f, R = A (1 - d) / d, and A the foot's inverse mass in the
    reference pose (`body_invweight0`). At rest f = k r / (A (1 - d)). So a foot with n
    contact points gets stiffness K by k = K A (1 - d) / n, and likewise B. Its apparent
    mass n / R is made a quarter of the foot's 1 / A by d. A sticking foot creeps at
    tangential force / B, slowed to a hundredth by an elliptic cone and `impratio` 100.

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
        "Look for soft soles, a carpet, or play in the ankles.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """("feet",) if the model's feet can touch a ground, else ()."""
        return ("feet",) if has_ground_contact(plant) else ()

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Stiffness K of one foot [N/m], on which the robot sinks by 0.1 to 30 mm."""
        weight = weight_n(plant)
        low, typical, high = (weight / sinks_m for sinks_m in (0.03, 4e-3, 1e-4))
        return (Parameter("stiffness", "N/m", low, high, np.inf, typical, True),)

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Make all feet of a variant soft, in series with any softness given before."""
        stiffness = values[0]
        if np.isinf(stiffness):
            return
        for foot in copies.plant.feet:
            _soften(copies, row, foot, stiffness)
        copies.field("opt.cone")[row] = mujoco.mjtCone.mjCONE_ELLIPTIC
        ratio = copies.field("opt.impratio")
        ratio[row] = np.maximum(ratio[row], _IMPEDANCE_RATIO)


def _soften(copies: Variants, row: int, foot: str, stiffness: float) -> None:
    """Give one foot a stiffness [N/m], in series with any that it was given before."""
    plant = copies.plant
    geoms = foot_geoms(plant, foot)
    points = _contact_points(plant, geoms)
    if points == 0:
        return
    impedance = _ADDED_MASS / (points + _ADDED_MASS)
    inverse_mass = float(plant.model.body_invweight0[copies.body(foot), 0])
    scale = inverse_mass * (1 - impedance) / points
    reference = copies.field("geom_solref")
    mix = copies.field("geom_solmix")
    if mix[row, geoms[0]] == _WEIGHT_OVER_GROUND:
        stiffness = 1 / (1 / stiffness - scale / reference[row, geoms[0], 0])
    damping = 2 * DAMPING_RATIO * np.sqrt(stiffness * mass_kg(plant))
    reference[row, geoms] = -scale * stiffness, -scale * damping
    copies.field("geom_solimp")[row, geoms, :2] = impedance
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
