"""Hidden flexibility of a link: it bends sideways, where no encoder sees it."""

import math
from typing import Any

import numpy as np

from worlds.hidden.effects.kind import HiddenKind, Quantity, Values
from worlds.hidden.plant import HiddenPlant
from worlds.hidden.setting import Setting


class LinkFlexibility(HiddenKind):
    """A link bends at its root, about an axis across that of its joint.

    A hinge with spring and damper, torque -stiffness b - damping db/dt at the bending
    angle b, without encoder: the first mode of a beam as a rigid body on a torsional
    spring (pseudo-rigid body; De Luca and Book 2016, "Robots with flexible elements",
    Springer handbook of robotics, section 11.2). Its axis is normal to the joint's and
    to the way from the joint to the link's centre of mass. First modes of arms lie
    between 3 and 30 Hz, with 1 to 5 % of critical damping.
    """

    name = "link_flexibility"
    rank = 37
    since = 2
    in_torques = True
    stiff = True
    place = "body"
    quantities = (
        Quantity("stiffness", "N m/rad", 1e-6),
        Quantity("damping", "N m s/rad", 0.0),
    )
    outside = True
    engines = ("mujoco",)

    def change_part(self, part: Any, values: Values) -> None:
        """Give the body another hinge, a spring, beside its joint."""
        (joint,) = part.joints
        part.add_joint(
            name=f"{part.name} bends",
            axis=across(np.array(joint.axis), np.array(part.ipos) - joint.pos),
            pos=joint.pos,
            stiffness=[values["stiffness"], 0, 0],
            damping=[values["damping"], 0, 0],
        )

    def size(self, s: Setting) -> dict[str, float]:
        """Stiffness for a mode at 60 (hard to detect) to 4 Hz (easy), lightly damped.

        The inertia is that about the link's own joint; the true mode is near.
        """
        inertia = float(s.scales.inertia_kg_m2[s.joint])
        stiffness = inertia * (2 * math.pi * s.part(4.0, 60.0)) ** 2
        critical = 2 * math.sqrt(stiffness * inertia)
        return {
            "stiffness": stiffness,
            "damping": float(s.rng.uniform(0.01, 0.05)) * critical,
        }

    def possible(self, plant: HiddenPlant) -> bool:
        """Whether the base is fixed and other joints feel the bending."""
        return not plant.floating and len(plant.joints) > 1


def across(axis: np.ndarray, way: np.ndarray) -> list[float]:
    """Unit vector (3,) normal to an axis (3,) and, unless it is parallel, to a way."""
    for other in (way, np.eye(3)[int(np.argmin(np.abs(axis)))]):
        normal = np.cross(axis, other)
        length = float(np.linalg.norm(normal))
        if length > 1e-6 * max(float(np.linalg.norm(other)), 1e-9):
            break
    return [float(value) for value in normal / length]
