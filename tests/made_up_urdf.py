"""URDFs of a robot on two legs whose every number is known."""

import numpy as np
from scipy.spatial.transform import Rotation

THIGH_M, SHIN_M, ANKLE_M, HIP_Y_M = 0.3, 0.25, 0.06, 0.08
AXES = {"yaw": (0, 0, 1), "roll": (1, 0, 0), "pitch": (0, 1, 0)}
ANKLE = ("ankle_pitch", "ankle_roll")


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


def link(name, mass, com=(0, 0, 0), shapes=""):
    return (
        f'<link name="{name}"><inertial><origin xyz="{numbers(com)}"/>'
        f'<mass value="{mass}"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" '
        f'ixz="0" iyz="0"/></inertial>{shapes}</link>'
    )


def joint(name, parent, child, place, axis, limits=(-1, 1), effort=50, speed=10):
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="{numbers(place)}"/>'
        f'<axis xyz="{numbers(axis)}"/><limit lower="{limits[0]}" upper="{limits[1]}" '
        f'effort="{effort}" velocity="{speed}"/></joint>'
    )


def two_legged(
    order=("yaw", "roll", "pitch"),
    facing_rad=0.0,
    flipped=(),
    hip_gap_m=0.0,
    knee_range=(0.0, 2.0),
    sole=True,
    arms=True,
):
    """A URDF as text.

    Args:
      order: of the three joints at the hip.
      facing_rad: about z, from the root's x axis to where it faces.
      flipped: roles whose axes point the other way.
      hip_gap_m: from each joint at the hip down to the next one.
      knee_range: of the knees, as long as they are not flipped.
      sole: whether the feet have shapes.
      arms: whether there are arms.
    """
    turn = Rotation.from_euler("z", facing_rad)
    parts = [link("base", 5.0, (0, 0, 0.2))]
    for side, y in (("a", HIP_Y_M), ("b", -HIP_Y_M)):
        parts += leg(side, y, order, flipped, hip_gap_m, knee_range, sole, turn)
        if arms:
            place = turn.apply((0, 1.5 * y, 0.3))
            across = turn.apply((0, 1, 0))
            parts += [
                link(f"arm_{side}", 1.0, turn.apply((0.2, 0, 0))),
                joint(
                    f"{side}_shoulder", "base", f"arm_{side}", place, across, (-2, 2)
                ),
                link(f"hand_{side}", 0.2),
                joint(
                    f"{side}_wrist", f"arm_{side}", f"hand_{side}", (0, 0, 0), across
                ),
            ]
    return f'<robot name="made_up">{"".join(parts)}</robot>'


def leg(side, y, order, flipped, gap_m, knee_range, sole, turn):
    roles = [*order, "knee", *ANKLE]
    places = [(0, y, 0), *[(0, 0, -gap_m)] * 2, (0, 0, 2 * gap_m - THIGH_M)]
    places += [(0, 0, -SHIN_M), (0, 0, 0)]
    parts, above = [], "base"
    for role, place in zip(roles, places, strict=True):
        axis = AXES[role.removeprefix("ankle_")] if role != "knee" else AXES["pitch"]
        limits = knee_range if role == "knee" else (-1.5, 1.5)
        sign = -1 if role in flipped else 1
        if sign < 0:
            limits = (-limits[1], -limits[0])
        shapes = ""
        if role == "ankle_roll" and sole:
            centre = turn.apply((0.03, 0, 0.02 - ANKLE_M))
            rpy = turn.as_euler("xyz")
            shapes = (
                f'<collision><origin xyz="{numbers(centre)}" rpy="{numbers(rpy)}"/>'
                '<geometry><box size="0.2 0.08 0.04"/></geometry></collision>'
            )
        name = f"{side}_{role}"
        parts.append(link(f"{name}_link", 0.5, shapes=shapes))
        parts.append(
            joint(
                name,
                above,
                f"{name}_link",
                turn.apply(place),
                sign * turn.apply(np.array(axis, float)),
                limits,
            )
        )
        above = f"{name}_link"
    return parts
