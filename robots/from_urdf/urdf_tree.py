"""A URDF as data: links with their inertials and shapes, and the joints between them.

Frames, names and signs are those of the file. Unlike the libraries yourdfpy and
urdf_parser_py, this module names the file in each error and replaces inertias that no
body can have.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadModelError
from robots.rigid_body import Inertial, inertia_matrix


@dataclass(frozen=True, eq=False)
class Placement:
    """Placement of an inner frame in an outer one: rotation (3, 3) and origin (3,) [m].

    Points transform as p_outer = rotation @ p_inner + position_m.
    """

    rotation: FloatArray
    position_m: FloatArray

    @classmethod
    def none(cls) -> "Placement":
        """Placement of a frame that coincides with the outer frame."""
        return cls(np.eye(3), np.zeros(3))

    @classmethod
    def turn(cls, vector_rad: FloatArray) -> "Placement":
        """Placement that only turns: rotation vector (3,), axis times angle [rad]."""
        if not vector_rad.any():
            return cls.none()
        return cls(Rotation.from_rotvec(vector_rad).as_matrix(), np.zeros(3))

    def __matmul__(self, inner: "Placement") -> "Placement":
        """Chain placements: `inner` of A in B and this one of B in C give A in C."""
        return Placement(self.rotation @ inner.rotation, self.points(inner.position_m))

    def points(self, points_m: FloatArray) -> FloatArray:
        """Transform points (..., 3) [m] from the inner frame to the outer one."""
        return np.asarray(points_m @ self.rotation.T + self.position_m)


Element = ElementTree.Element
MOVING = ("revolute", "continuous")
_WATER_KG_M3, _THIN = 1000.0, 1e-3
_AXES = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


@dataclass(frozen=True, eq=False)
class UrdfShape:
    """A visual or collision shape of a link in a URDF, placed in the link's frame.

    It is a "box", "cylinder", "sphere" or "mesh"; `values` are the XML attributes as
    text, such as size, radius, length, filename and scale.
    """

    kind: str
    values: Mapping[str, str]
    placement: Placement


@dataclass(frozen=True, eq=False)
class UrdfLink:
    """A link of a URDF; its inertial is in the link's frame, None if it has no mass."""

    name: str
    inertial: Inertial | None
    visual: tuple[UrdfShape, ...]
    collision: tuple[UrdfShape, ...]


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint of a URDF that connects the links `parent` and `child`.

    It is `moving` if it is a hinge that moves by itself, no `mimic` of another joint.
    The placement is that of the child's frame in the parent's with the joint at zero;
    the axis is a unit vector (3,) in the child's frame. The range is -2 pi to 2 pi if
    the file has no limits; effort and speed limits are None if the file does not say.
    """

    name: str
    moving: bool
    parent: str
    child: str
    placement: Placement
    axis: FloatArray
    range_rad: tuple[float, float]
    effort_nm: float | None
    speed_rad_s: float | None


@dataclass(frozen=True, eq=False)
class UrdfTree:
    """The robot of a URDF: links and joints by name; parent joints come first."""

    path: Path
    root: str
    links: Mapping[str, UrdfLink]
    joints: Mapping[str, UrdfJoint]

    @cached_property
    def above(self) -> dict[str, UrdfJoint]:
        """For each link but the root, the joint of which it is the child."""
        return {joint.child: joint for joint in self.joints.values()}

    def mass_kg(self, link: str) -> float:
        """Mass [kg] of a link and of all links below it."""
        own = self.links[link].inertial
        below = [one.child for one in self.joints.values() if one.parent == link]
        return (own.mass_kg if own else 0.0) + sum(map(self.mass_kg, below))

    def chain(self, link: str) -> list[str]:
        """Names of the moving joints on the path from the root to a link."""
        names: list[str] = []
        while link != self.root:
            joint = self.above[link]
            if joint.moving:
                names.insert(0, joint.name)
            link = joint.parent
        return names

    def placements(self, angles_rad: Mapping[str, float]) -> dict[str, Placement]:
        """Placement of every link in the root link's frame; angles [rad] by name."""
        placed = {self.root: Placement.none()}
        for joint in self.joints.values():
            turn = angles_rad.get(joint.name, 0.0) * joint.axis
            placed[joint.child] = (
                placed[joint.parent] @ joint.placement @ Placement.turn(turn)
            )
        return placed


def read_urdf(path: Path) -> UrdfTree:
    """Read the robot of a URDF file.

    Raises:
      BadModelError: the file cannot be read, is no URDF, or its joints form no tree.
    """
    try:
        robot = ElementTree.parse(path).getroot()
    except (ElementTree.ParseError, OSError) as error:
        raise BadModelError(f"{path} cannot be read: {error}") from error
    if robot.tag != "robot":
        raise BadModelError(
            f"{path} is no URDF: its root is <{robot.tag}>, not <robot>"
        )
    try:
        links = [_link(element) for element in robot.findall("link")]
        joints = [_joint(element) for element in robot.findall("joint")]
    except (ValueError, KeyError) as error:
        raise BadModelError(f"{path} is no sound URDF: {error}") from error
    named = {link.name: link for link in links}
    children = {joint.child for joint in joints}
    roots = [name for name in named if name not in children]
    if len(roots) != 1 or not children <= set(named):
        raise BadModelError(f"{path}: its links make no tree; roots are {roots}")
    return UrdfTree(path, roots[0], named, _sorted(roots[0], joints))


def _sorted(root: str, joints: list[UrdfJoint]) -> dict[str, UrdfJoint]:
    """Joints by name, each after its parent joint (depth first from the root link)."""
    below: dict[str, list[UrdfJoint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    ordered: dict[str, UrdfJoint] = {}
    waiting = below.get(root, [])[::-1]
    while waiting:
        joint = waiting.pop()
        ordered[joint.name] = joint
        waiting += below.get(joint.child, [])[::-1]
    return ordered


def _link(element: Element) -> UrdfLink:
    return UrdfLink(
        element.attrib["name"],
        _inertial(element.find("inertial")),
        tuple(_shapes(element, "visual")),
        tuple(_shapes(element, "collision")),
    )


def _inertial(element: Element | None) -> Inertial | None:
    """Mass and inertia, the latter a possible one; None without a mass."""
    mass = 0.0 if element is None else _number(element.find("mass"), "value") or 0.0
    if element is None or mass <= 0:
        return None
    frame = _placement(element)
    moments = element.find("inertia")
    given = [_number(moments, axis) or 0.0 for axis in _AXES]
    own = _possible(inertia_matrix(given), mass)
    turned = frame.rotation @ own @ frame.rotation.T
    return Inertial(mass, frame.position_m, turned)


def _possible(inertia: FloatArray, mass_kg: float) -> FloatArray:
    """An inertia matrix (3, 3) if a body can have it, else a close possible one.

    If all moments are below a thousandth of those of a ball of water of that mass, as
    in iCub's right leg, the ball's are used. Other wrong ones are corrected as by
    MuJoCo's `balanceinertia`.
    """
    moments, axes = np.linalg.eigh(inertia)
    radius_m = (3 * mass_kg / (4 * np.pi * _WATER_KG_M3)) ** (1 / 3)
    ball = 0.4 * mass_kg * radius_m**2
    if moments[2] < _THIN * ball:
        return np.asarray(ball * np.eye(3))
    if moments[0] > 0 and moments[0] + moments[1] >= moments[2]:
        return inertia
    moments = np.maximum(moments, _THIN * moments[2])
    if moments[0] + moments[1] < moments[2]:
        moments[:] = moments.mean()
    return np.asarray(axes @ np.diag(moments) @ axes.T)


def _shapes(link: Element, kind: str) -> list[UrdfShape]:
    shapes = []
    for element in link.findall(kind):
        geometry = element.find("geometry")
        if geometry is not None and len(geometry):
            form = geometry[0]
            shapes.append(UrdfShape(form.tag, form.attrib, _placement(element)))
    return shapes


def _joint(element: Element) -> UrdfJoint:
    parent, child = element.find("parent"), element.find("child")
    if parent is None or child is None:
        raise ValueError(f"joint {element.get('name')} lacks a parent or a child")
    axis = _vector(element.find("axis"), "xyz", "1 0 0")
    limit = element.find("limit")
    kind = element.get("type")
    low, high = _number(limit, "lower"), _number(limit, "upper")
    if kind == "continuous" or low is None or high is None or not low < high:
        low, high = -2 * np.pi, 2 * np.pi
    return UrdfJoint(
        name=element.attrib["name"],
        moving=kind in MOVING and element.find("mimic") is None,
        parent=parent.attrib["link"],
        child=child.attrib["link"],
        placement=_placement(element),
        axis=axis / (np.linalg.norm(axis) or 1.0),
        range_rad=(low, high),
        effort_nm=_number(limit, "effort"),
        speed_rad_s=_number(limit, "velocity"),
    )


def _placement(element: Element) -> Placement:
    origin = element.find("origin")
    turn = Rotation.from_euler("xyz", _vector(origin, "rpy", "0 0 0"))
    return Placement(turn.as_matrix(), _vector(origin, "xyz", "0 0 0"))


def _vector(element: Element | None, name: str, default: str) -> FloatArray:
    text = default if element is None else element.get(name, default)
    values = np.array(text.split(), float)
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(f"{name} is {text!r}; it must be three numbers")
    return values


def _number(element: Element | None, name: str) -> float | None:
    text = None if element is None else element.get(name)
    return None if text is None else float(text)
