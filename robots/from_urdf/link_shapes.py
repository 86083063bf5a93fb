"""Soles of feet from a URDF's shapes, and capsules to draw robots without shapes."""

import math
from collections.abc import Iterator

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError
from robots.description import Capsule, Foot
from robots.from_urdf.adaptation import SoleBox
from robots.from_urdf.mesh_files import mesh_path, read_mesh
from robots.from_urdf.posed_tree import PosedTree
from robots.from_urdf.urdf_tree import UrdfShape

THICKNESS_M = 0.005
"""Points of a foot less than this height [m] above its lowest point form the sole."""

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
_AROUND = np.linspace(0, 2 * np.pi, 24, endpoint=False)


def foot(
    posed: PosedTree, joint: str, index: int, box: SoleBox | None, side: int
) -> Foot:
    """Describe a foot, whose sole is given or the bottom of its collision shapes.

    Its four force sensors are at the corners of the rectangle around the sole. `joint`
    is the leg's last one, `index` its column in joint arrays; `box` is the left sole,
    None to take it from the shapes; `side` is 1 left, -1 right.
    """
    if box is None:
        points_m = _points(posed, joint) - posed.origin_m(joint)
        height_m = float(points_m[:, 2].min())
        sole = points_m[points_m[:, 2] < height_m + THICKNESS_M, :2]
    else:
        height_m = box.height_m
        sole = np.array([[x, side * y] for x in box.x_m for y in box.y_m])
    try:
        outline_m = sole[ConvexHull(sole).vertices]
    except (QhullError, ValueError):
        raise BadModelError(
            f"{posed.tree.path}: the foot of {joint} has no flat bottom; give its sole"
        ) from None
    if height_m >= 0:
        raise BadModelError(f"{posed.tree.path}: {joint} lies below its foot's sole")
    (back, right), (front, left) = outline_m.min(axis=0), outline_m.max(axis=0)
    sensors = [[front, left], [front, right], [back, left], [back, right]]
    return Foot(index, height_m, outline_m, np.array(sensors))


def shape_points(posed: PosedTree, shape: UrdfShape) -> FloatArray:
    """(points, 3) corners of a shape in its own frame [m]; for cylinders 24-gons."""
    values = shape.values
    if shape.kind == "mesh":
        path = mesh_path(posed.tree.path, values["filename"])
        return read_mesh(path).vertices * _numbers(values.get("scale", "1 1 1"))
    if shape.kind == "box":
        return _CORNERS * _numbers(values["size"]) / 2
    radius = float(values["radius"])
    if shape.kind == "sphere":
        return radius * np.vstack([np.eye(3), -np.eye(3)])
    half = float(values["length"]) / 2
    ring = radius * np.stack([np.cos(_AROUND), np.sin(_AROUND)], axis=1)
    return np.vstack(
        [np.hstack([ring, np.full((len(ring), 1), z)]) for z in (-half, half)]
    )


def _points(posed: PosedTree, joint: str) -> FloatArray:
    """(points, 3) of a foot's collision (or visual) shapes in the root frame [m]."""
    for kind in ("collision", "visual"):
        parts = list(_of_kind(posed, joint, kind))
        if parts:
            return np.vstack(parts)
    raise BadModelError(
        f"{posed.tree.path}: the foot of {joint} has no shape; give its sole"
    )


def _of_kind(posed: PosedTree, joint: str, kind: str) -> Iterator[FloatArray]:
    for link in posed.carried(joint):
        for shape in getattr(link, kind):
            place = posed.placed[link.name] @ shape.placement
            if shape.kind == "sphere":
                place = type(place)(np.eye(3), place.position_m)
            yield place.points(shape_points(posed, shape))


def _numbers(text: str) -> FloatArray:
    return np.array(text.split(), float)


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
