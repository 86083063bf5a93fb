"""Effects at bodies: mass, where it sits and how far it spreads, drag, and pushes."""

from collections.abc import Sequence

import mujoco
import numpy as np

from diagnosis.effects.base_kinds import BodyEffect, NumberEffect
from diagnosis.effects.parts import EARLIEST_S, LONGEST_S, EffectWords, Parameter
from diagnosis.effects.scales import mass_kg, weight_n
from diagnosis.effects.variants import Push, Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray

MOST = 5.0
"""Largest payload, as a multiple of the robot model's mass: a small robot may carry
more than it weighs, and a model may state far too little."""

MOST_TAKEN = 0.9
"""Largest share of a body's mass that the robot may lack: something is left of it."""

_HINGE = mujoco.mjtJoint.mjJNT_HINGE.value
_SLIDE = mujoco.mjtJoint.mjJNT_SLIDE.value

_ABOUT_ITS_CENTRE = 1
"""MuJoCo's `body_simple` for a simple body that can rotate; 2 is for one that only
slides."""


class PayloadMass(NumberEffect, BodyEffect):
    """A point mass m at a body's centre of mass; below 0 the robot lacks it.

    Centre of mass and inertia about it stay as they are, since a point mass at distance
    r adds m r^2 (Featherstone 2008, "Rigid body dynamics algorithms", section 2.13). In
    MuJoCo `body_mass`.
    """

    name = "payload_mass"
    shown_by = "poses"
    native = True
    by_inverse_dynamics = True
    quantity = "body_mass"
    words = EffectWords(
        "extra mass",
        "{body} carries {mass} {lacking}",
        "A load, a battery or a cable that the model does not know of, or that it has "
        "and the robot not.",
        "Weigh the part with its cables and screws.",
        below="{body} is lighter than {usual}, by {mass}",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The mass [kg], at most `MOST` times that of the whole robot.

        Of what the body itself has, the robot may lack `MOST_TAKEN`.
        """
        own = float(plant.model.body(place).mass[0])
        low, high = -MOST_TAKEN * own, MOST * mass_kg(plant)
        return (Parameter("mass", "kg", low, high, 0.0, 0.2 * own),)

    def tolerance(self, plant: Plant, place: str) -> float:
        """1 % of the body's own mass: what CAD says of a body without cables."""
        return 0.01 * float(plant.model.body(place).mass[0])

    def spread(self, plant: Plant, place: str) -> float:
        """2 %: CAD leaves out cables, screws and glue."""
        return 0.02 * float(plant.model.body(place).mass[0])


class ComOffset(NumberEffect, BodyEffect):
    """The centre of mass is shifted by (x, y, z) in the body's frame.

    Mass and inertia about the centre stay as they are.

    Source: first moments among the inertial parameters, Atkeson, An and Hollerbach
    1986, "Estimation of inertial parameters of manipulator loads and links". In MuJoCo
    `body_ipos`.
    """

    name = "com_offset"
    shown_by = "poses"
    native = True
    components = 3
    by_inverse_dynamics = True
    rarity_nats = 1.0
    quantity = "body_ipos"
    usual = tuple(Parameter(axis, "m", -0.1, 0.1, 0.0, 0.01) for axis in "xyz")
    words = EffectWords(
        "shifted centre of mass",
        "the centre of mass of {body} is shifted from its place {usual} by {x} in x, "
        "{y} in y and {z} in z",
        "The mass is right, but sits elsewhere in the body.",
        "Balance the part on an edge; look for batteries, cables and screws that its "
        "drawing lacks.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of bodies, except those that MuJoCo's compiler has made simple.

        MuJoCo's mass matrix has no entries for the coupling that an offset of a simple
        body causes. `simple="false"` in the model avoids this.
        """
        every = super().places(plant, traces)
        return tuple(name for name in every if not _is_simple(plant, name))

    def tolerance(self, plant: Plant, place: str) -> float:
        """1 % of the centre's distance from the joint and of the radius of gyration."""
        body = plant.model.body(place)
        gyration_m = float(np.sqrt(body.inertia.max() / body.mass[0]))
        return 0.01 * (gyration_m + float(np.linalg.norm(body.ipos)))


class LinkInertia(NumberEffect, BodyEffect):
    """A factor on the rotational inertia of a body about its centre of mass.

    Mass and centre of mass stay as they are: the same mass is spread wider, or less
    wide. With any factor above 0 the inertia remains one that a body can have, since
    its pseudo-inertia, the matrix of second moments of the mass, stays positive
    (Wensing, Kim and Slotine 2018, "Linear matrix inequalities for physically
    consistent inertial parameter identification"). In MuJoCo `body_inertia`.
    """

    name = "link_inertia"
    shown_by = "accelerations"
    native = True
    by_inverse_dynamics = True
    quantity = "body_inertia"
    combined = np.multiply
    usual = (Parameter("factor", "1", 0.01, 100.0, 1.0, 1.5, logarithmic=True),)
    words = EffectWords(
        "rotational inertia",
        "{body} has {factor} times its rotational inertia {usual}",
        "The mass is right, but sits closer to its centre or further from it, as where "
        "a model has a box in place of the part.",
        "Let the part swing on two threads, and take its inertia from the period; or "
        "export it from CAD with the right materials.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of bodies that can turn about more than one axis.

        With one it is the same as rotor inertia there. Of a body that MuJoCo's compiler
        has made simple the inertia is fixed.
        """
        return tuple(
            name
            for name in super().places(plant, traces)
            if _axes(plant, name) > 1 and not _is_simple(plant, name)
        )


class Drag(NumberEffect, BodyEffect):
    """Force -c v at a body's centre of mass, with v the velocity of that point.

    Source: drag at low speed, linear as Stokes 1851 found for a sphere.
    """

    name = "drag"
    shown_by = "speeds"
    native = False
    at_tips = True
    rarity_nats = 3.0
    quantity = "drag_n_s_m"
    words = EffectWords(
        "drag",
        "{body} meets a drag of {coefficient} {lacking}",
        "A force against the body's velocity, as of air, water or a trailing cable.",
        "Look for what drags along: a cable, water, a cover.",
    )

    def places(self, plant: Plant, traces: Sequence[Trace]) -> tuple[str, ...]:
        """Names of bodies that move, except those that a single joint moves.

        Drag of those is the same as viscous friction of that joint.
        """
        every = super().places(plant, traces)
        return tuple(name for name in every if not _on_one_joint(plant, name))

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """The coefficient c [N s/m], typically 10 % of the robot's weight at 1 m/s."""
        scale = weight_n(plant)
        return (Parameter("coefficient", "N s/m", 0.0, 2 * scale, 0.0, 0.1 * scale),)


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
        "Look at what was around the robot at that time: a person, a cable, an "
        "obstacle.",
    )

    def parameters(self, plant: Plant, place: str) -> tuple[Parameter, ...]:
        """Force x, y, z [N], each up to the robot's weight; start and duration [s]."""
        weight = weight_n(plant)
        force = (Parameter(a, "N", -weight, weight, 0.0, 0.05 * weight) for a in "xyz")
        return (
            *force,
            Parameter("start", "s", EARLIEST_S, LONGEST_S, 0.0, 0.2),
            Parameter("duration", "s", 0.0, LONGEST_S, 0.0, 0.2),
        )

    def apply(self, copies: Variants, row: int, place: str, values: FloatArray) -> None:
        """Add the push to one variant of the model; overlapping forces add up."""
        x, y, z, start_s, duration_s = (float(value) for value in values)
        if duration_s > 0 and any((x, y, z)):
            push = Push(place, (x, y, z), start_s, duration_s)
            copies.outside.pushes[row].append(push)


def _is_simple(plant: Plant, name: str) -> bool:
    """Whether MuJoCo takes a body's entries of the mass matrix as constant."""
    return bool(plant.model.body(name).simple[0] == _ABOUT_ITS_CENTRE)


def _on_one_joint(plant: Plant, name: str) -> bool:
    """Whether a body can only turn about one axis, or slide along one line."""
    joints = _joints_below(plant, name)
    return len(joints) == 1 and joints[0] in (_HINGE, _SLIDE)


def _axes(plant: Plant, name: str) -> int:
    """Number of axes about which a body can turn; parallel ones count as several."""
    axes = {_HINGE: 1, _SLIDE: 0}
    return sum(axes.get(kind, 3) for kind in _joints_below(plant, name))


def _joints_below(plant: Plant, name: str) -> list[int]:
    """MuJoCo's types of all joints that move a body, from its own to the base's."""
    model = plant.model
    body = int(model.body(name).id)
    joints: list[int] = []
    while body > 0:
        first = int(model.body_jntadr[body])
        joints += list(model.jnt_type[first : first + int(model.body_jntnum[body])])
        body = int(model.body_parentid[body])
    return joints
