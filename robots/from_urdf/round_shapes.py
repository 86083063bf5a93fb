"""Draws a robot without shapes of its own as capsules between joints, sized by mass."""

import math

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Capsule
from robots.from_urdf.posed_tree import PosedTree

DENSITY_KG_M3 = 1000.0
"""Assumed mean density of links [kg/m^3]: that of water, and about that of robots."""

_THINNEST, _THICKEST = 0.02, 0.09
"""Smallest and largest capsule radius, as shares of the root's height above the soles;
chosen by eye."""

_SHORTEST_M = 0.01
"""Smallest distance [m] between two joints of a link at which a capsule is drawn."""

_END = 0.005
"""Share of the robot's mass above which a link that carries no joint is drawn."""


def round_shapes(posed: PosedTree, joint: str, height_m: float) -> tuple[Capsule, ...]:
    """Capsules of all links that move with a joint ("": the root), in its frame.

    A capsule runs from each link's joint to every joint that the link carries; the
    capsules of a link share its volume. A link with mass that carries no joint becomes
    a ball around its centre of mass, connected to the link above by a thin neck.
    `height_m`, the root's height above the soles, bounds the radii.
    """
    origin_m = posed.origin_m(joint)
    least_m, most_m = _THINNEST * height_m, _THICKEST * height_m
    shapes: list[Capsule] = []
    for link in posed.carried(joint):
        mass_kg = 0.0 if link.inertial is None else link.inertial.mass_kg
        bones = _bones_m(posed, link.name)
        total_m = sum(float(np.linalg.norm(end - start)) for start, end in bones)
        if bones:
            thick_m = math.sqrt(mass_kg / (DENSITY_KG_M3 * math.pi * total_m))
            radius_m = min(max(thick_m, least_m), most_m)
        elif link.inertial is not None and mass_kg > _END * posed.hanging("").mass_kg:
            centre_m = posed.placed[link.name].points(link.inertial.com_m)
            thick_m = (3 * mass_kg / (4 * math.pi * DENSITY_KG_M3)) ** (1 / 3)
            radius_m = min(thick_m, most_m)
            start_m = _carrier_m(posed, link.name)
            if np.linalg.norm(centre_m - start_m) > radius_m:
                neck = _capsule(start_m - origin_m, centre_m - origin_m, least_m)
                shapes.append(neck)
            bones = [(centre_m, centre_m)]
        shapes += [
            _capsule(start - origin_m, end - origin_m, radius_m) for start, end in bones
        ]
    return tuple(shapes)


def _carrier_m(posed: PosedTree, link: str) -> FloatArray:
    """(3,) start of a link [m] in the root's frame: its joint, or parent if fixed."""
    above = posed.tree.above.get(link)
    if above is not None and posed.carriers[above.parent] == posed.carriers[link]:
        return posed.placed[above.parent].position_m
    return posed.placed[link].position_m


def _bones_m(posed: PosedTree, link: str) -> list[tuple[FloatArray, FloatArray]]:
    """Start and end in the root's frame [m] of lines from a link's joint to the next.

    Joints that carry no mass are left out, and lines shorter than `_SHORTEST_M`.
    """
    start, tree = posed.placed[link].position_m, posed.tree
    carried = [one.child for one in tree.joints.values() if one.parent == link]
    ends = [posed.placed[child].position_m for child in carried if tree.mass_kg(child)]
    return [(start, end) for end in ends if np.linalg.norm(end - start) > _SHORTEST_M]


def _capsule(start: FloatArray, end: FloatArray, radius_m: float) -> Capsule:
    (ax, ay, az), (bx, by, bz) = start.tolist(), end.tolist()
    return Capsule((ax, ay, az), (bx, by, bz), float(radius_m))
