"""Parts of a URDF that both of its writers need: links, spheres and hinges."""

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from groundwalk.arrays import FloatArray
from robots.rigid_body import Inertial


def numbers(values: Iterable[float]) -> str:
    """Numbers as text, with all their digits."""
    return " ".join(repr(float(value)) for value in values)


def text_of(robot: Element, declared: bool) -> str:
    """The URDF as indented text, with an XML declaration or without one."""
    indent(robot)
    return tostring(robot, encoding="unicode", xml_declaration=declared) + "\n"


def add_origin(parent: Element, place_m: Iterable[float], rpy: str = "0 0 0") -> None:
    """Place an element at a position (3,) [m], turned by roll, pitch and yaw [rad]."""
    SubElement(parent, "origin", xyz=numbers(place_m), rpy=rpy)


def add_link(robot: Element, name: str, inertial: Inertial) -> Element:
    """Add a link with a mass to the robot."""
    link = SubElement(robot, "link", name=name)
    body = SubElement(link, "inertial")
    add_origin(body, inertial.com_m)
    SubElement(body, "mass", value=repr(inertial.mass_kg))
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    moments = inertial.inertia_kg_m2[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist()
    SubElement(body, "inertia", dict(zip(names, map(repr, moments), strict=True)))
    return link


def add_sphere(link: Element, kind: str, place_m: FloatArray, radius_m: float) -> None:
    """Add a sphere to a link; `kind` is "visual" or "collision"."""
    element = SubElement(link, kind)
    add_origin(element, place_m)
    SubElement(SubElement(element, "geometry"), "sphere", radius=repr(radius_m))


def add_hinge(
    robot: Element,
    names: tuple[str, str, str],
    place_m: FloatArray,
    rpy: str,
    axis: FloatArray,
    limit: tuple[float, float, str, str],
) -> Element:
    """Add a hinge to the robot.

    Args:
      robot: the root element of the URDF.
      names: names of the joint, of the link that carries it and of the link it moves.
      place_m: (3,) position in the carrying link's frame [m].
      rpy: roll, pitch and yaw [rad] of the moved link in that frame.
      axis: (3,) axis in the moved link's frame.
      limit: lower and upper end [rad], largest torque [N m] and speed [rad/s].
    """
    name, parent, child = names
    element = SubElement(robot, "joint", name=name, type="revolute")
    SubElement(element, "parent", link=parent)
    SubElement(element, "child", link=child)
    add_origin(element, place_m, rpy)
    SubElement(element, "axis", xyz=numbers(axis))
    lower, upper, effort, velocity = limit
    ends = {"lower": repr(lower), "upper": repr(upper)}
    SubElement(element, "limit", ends, effort=effort, velocity=velocity)
    return element
