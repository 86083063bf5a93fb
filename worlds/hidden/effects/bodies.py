"""Hidden physics of bodies: inertia, mass, centre of mass, and forces on one body."""

from typing import Any

import numpy as np

from groundwalk.errors import BadValueError
from groundwalk.gravity import GRAVITY_M_S2
from worlds.hidden.effects.kind import HiddenKind, Push, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import LEAST_LEVER_M, Scales, Setting, Spot


class _OneJointOneWeight(HiddenKind):
    """Hidden physics that changes the load of a joint: its weight or its inertia."""

    def cancels(self, plant: HiddenPlant) -> bool:
        """Whether the robot has one joint, where weight and inertia look alike."""
        return len(plant.joints) == 1


class _Weight(_OneJointOneWeight):
    """Hidden physics that changes a body's mass or centre of mass."""

    place = "body"

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the motion shows a change of the body's weight.

        On a floating base the body has to move: else the ground just carries it. On a
        fixed one its weight must load a moving joint: else the change acts as an
        encoder offset, or not at all.
        """
        if plant.floating:
            return scales.moves(spot.body)
        return scales.feels_weight(spot.body)


class Armature(_OneJointOneWeight):
    """Extra inertia of a joint from a rotor behind its gear."""

    name = "armature"
    rank = 15
    in_torques = True
    quantities = (Quantity("inertia", "kg m^2", 0.0),)
    engines = ("mujoco",)
    needs_motion = True
    apart = ("payload_mass", "com_offset")

    def change_part(self, part: Any, values: Values) -> None:
        """Add the inertia to the joint's armature, which only MuJoCo has."""
        part.armature += values["inertia"]

    def size(self, s: Setting) -> dict[str, float]:
        """Inertia of 0.1 (hard to detect) to 3 times (easy) the joint's own."""
        return {"inertia": s.part(3, 0.1) * float(s.scales.inertia_kg_m2[s.joint])}


class PayloadMass(_Weight):
    """An extra point mass at a body's centre of mass, or one that it lacks."""

    name = "payload_mass"
    rank = 16
    in_torques = True
    quantities = (Quantity("mass", "kg", -1000.0, 1000.0),)
    apart = ("com_offset", "armature")

    def change_part(self, part: Any, values: Values) -> None:
        """Add the payload to the body's mass; below 0 it is taken from it."""
        if part.mass + values["mass"] <= 0:
            raise BadValueError(
                f"payload_mass: {-values['mass']:g} kg cannot be taken from the body "
                f"'{part.name}', which has {part.mass:g} kg"
            )
        part.mass += values["mass"]

    def size(self, s: Setting) -> dict[str, float]:
        """Mass of 1 % (hard to detect) to 30 % (easy) of what the joint carries."""
        return {"mass": s.part(0.3, 0.01) * float(s.scales.carried_kg[s.joint])}


class ComOffset(_Weight):
    """A shift of a body's centre of mass from where the nominal model has it."""

    name = "com_offset"
    rank = 17
    in_torques = True
    quantities = tuple(Quantity(axis, "m", -1.0, 1.0) for axis in "xyz")
    apart = ("payload_mass", "armature")

    def change_part(self, part: Any, values: Values) -> None:
        """Shift the centre of mass, along the axes of the body's frame."""
        part.ipos = part.ipos + np.array([values[axis] for axis in "xyz"])

    def size(self, s: Setting) -> dict[str, float]:
        """Shift of 3 (hard to detect) to 50 mm (easy), normal to the joint's axis.

        A shift along the axis would not load the joint. In the last body of a chain the
        shift is away from or towards the axis: one to the side would act as a rotation
        of the whole link, and thus as an encoder offset.
        """
        size_m, arm_m = s.part(0.05, 0.003), s.scales.arm_m[s.joint]
        length_m = float(np.linalg.norm(arm_m))
        if s.at_end and length_m >= LEAST_LEVER_M:
            shift = s.sign * size_m * arm_m / length_m
        else:
            shift = size_m * s.across
        return dict(zip("xyz", shift.tolist(), strict=True))


class _OnSeveralJoints(HiddenKind):
    """Hidden physics of a body that with one joint looks like that of the joint."""

    place = "body"

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether several joints move the body, and it does move."""
        many = plant.floating or scales.carriers(spot.body) > 1
        return scales.moves(spot.body) and many


class LinkInertia(_OnSeveralJoints):
    """Rotational inertia of a body about its centre of mass, `factor` times as large.

    With one joint it is rotor inertia.
    Sets of concealed cases before 5 do not have it.
    """

    name = "link_inertia"
    since = 5
    in_torques = True
    quantities = (Quantity("factor", "1", 1e-3, 1000.0),)

    def change_part(self, part: Any, values: Values) -> None:
        """Scale the inertia, whether its principal moments or its matrix are given."""
        if not part.explicitinertial:
            raise BadValueError(
                f"link_inertia: the model states no inertia of the body '{part.name}'"
            )
        part.inertia = part.inertia * values["factor"]
        part.fullinertia = part.fullinertia * values["factor"]

    def size(self, s: Setting) -> dict[str, float]:
        """Factor of 1.2 (hard to detect) to 5 (easy), or as much below 1."""
        return {"factor": (1 + s.part(4.0, 0.2)) ** s.sign}


_LASTING_SHARE = 0.3
"""Share of randomly drawn forces that act during the whole recording, where possible.
The others are short pushes."""


class ExternalForce(HiddenKind):
    """A constant force pushes a body's centre of mass for some time."""

    name = "external_force"
    rank = 25
    in_torques = True
    place = "body"
    quantities = (
        *(Quantity(axis, "N") for axis in "xyz"),
        Quantity("start", "s"),
        Quantity("duration", "s", 0.0),
    )

    def push(self, values: Values) -> Push:
        """Law of the force: constant in the world frame from start for its duration."""
        force_n = np.array([values[axis] for axis in "xyz"])
        start_s, duration_s = values["start"], values["duration"]
        return lambda time_s, velocity: (
            force_n if 0 <= time_s - start_s < duration_s else None
        )

    def size(self, s: Setting) -> dict[str, float]:
        """Force of 0.5 % (hard to detect) to 10 % (easy) of the moving parts' weight.

        It mostly acts for 0.05 to 0.5 s. A lasting force is only drawn where several
        joints move the body: elsewhere it could not be distinguished from a payload.
        """
        weight_n = s.scales.moving_kg * GRAVITY_M_S2
        way = s.across if len(s.plant.joints) == 1 else s.direction
        force = s.part(0.1, 0.005) * weight_n * way
        if s.many_joints and s.rng.uniform() < _LASTING_SHARE:
            span = {"start": 0.0, "duration": 1.5 * s.duration_s}
        else:
            start = s.rng.uniform(0.15, 0.8) * s.duration_s
            span = {"start": float(start), "duration": float(s.rng.uniform(0.05, 0.5))}
        return dict(zip("xyz", force.tolist(), strict=True)) | span

    def shows(self, plant: HiddenPlant, scales: Scales, spot: Spot) -> bool:
        """Whether the body moves; on a still one the force would show nowhere."""
        return scales.moves(spot.body)


class Drag(_OnSeveralJoints):
    """A force on a body, opposed and proportional to its velocity.

    With one joint it is viscous friction.
    """

    name = "drag"
    rank = 26
    in_torques = True
    quantities = (Quantity("coefficient", "N s/m", 0.0),)

    def push(self, values: Values) -> Push:
        """Law of the force: -coefficient v, v the velocity of the centre of mass."""
        coefficient = values["coefficient"]
        return lambda time_s, velocity: -coefficient * velocity()

    def size(self, s: Setting) -> dict[str, float]:
        """Drag at 1 m/s of 2 % (hard to detect) to 40 % (easy) of the moving weight."""
        weight_n = s.scales.moving_kg * GRAVITY_M_S2
        return {"coefficient": s.part(0.4, 0.02) * weight_n}
