"""Makes the URDF of a robot from its description.

The only collision shapes are small spheres around the soles, as in the MuJoCo model.
There are no massless links: PyBullet would give each of them 1 kg.
"""

from collections.abc import Iterable
from xml.etree import ElementTree

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Capsule, Description, Foot, Joint, Link
from robots.rigid_body import Inertial
from robots.sole import CONTACT_RADIUS_M, contact_points

Element = ElementTree.Element


def urdf(description: Description) -> str:
    """Make the URDF text of a robot, with rotor inertias lumped into the links.

    Effort limits are the motors' stall torques, velocity limits their speeds without
    load. Coupled joints have a `mimic` element, which PyBullet ignores.
    """
    robot = Element("robot", name=description.name)
    feet = {foot.joint: foot for foot in description.feet}
    _add_link(robot, description.root, description.root.inertial, None)
    for i, joint in enumerate(description.links):
        _add_link(robot, joint.link, joint.moved_inertial, feet.get(i))
    followers = {second: first for first, second in description.coupled}
    for i, joint in enumerate(description.links):
        parent = description.root
        if joint.parent >= 0:
            parent = description.links[joint.parent].link
        element = _add_joint(robot, joint, parent.name)
        if i in followers:
            leader = description.joints[followers[i]]
            ElementTree.SubElement(element, "mimic", joint=leader)
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)


def _add_origin(parent: Element, place_m: Iterable[float], rpy: str = "0 0 0") -> None:
    ElementTree.SubElement(parent, "origin", xyz=_numbers(place_m), rpy=rpy)


def _add_link(
    robot: Element, link: Link, inertial: Inertial, foot: Foot | None
) -> None:
    element = ElementTree.SubElement(robot, "link", name=link.name)
    body = ElementTree.SubElement(element, "inertial")
    _add_origin(body, inertial.com_m)
    ElementTree.SubElement(body, "mass", value=repr(inertial.mass_kg))
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    moments = inertial.inertia_kg_m2[rows, columns].tolist()
    ElementTree.SubElement(
        body, "inertia", dict(zip(names, map(repr, moments), strict=True))
    )
    for shape in link.shapes:
        _add_capsule(element, shape)
    if foot is not None:
        for x, y in contact_points(foot):
            centre = np.array([x, y, foot.sole_height_m + CONTACT_RADIUS_M])
            _add_sphere(element, "collision", centre, CONTACT_RADIUS_M)


def _add_sphere(link: Element, kind: str, place_m: FloatArray, radius_m: float) -> None:
    element = ElementTree.SubElement(link, kind)
    _add_origin(element, place_m)
    geometry = ElementTree.SubElement(element, "geometry")
    ElementTree.SubElement(geometry, "sphere", radius=repr(radius_m))


def _add_capsule(link: Element, shape: Capsule) -> None:
    """Add a capsule to a link as visual spheres and cylinder; URDF has no capsules."""
    start, end = np.array(shape.start_m), np.array(shape.end_m)
    _add_sphere(link, "visual", start, shape.radius_m)
    length = float(np.linalg.norm(end - start))
    if length == 0:
        return
    _add_sphere(link, "visual", end, shape.radius_m)
    direction = (end - start) / length
    # roll, pitch, yaw that turn the z axis into the direction, with yaw zero
    roll = -np.arcsin(direction[1])
    pitch = np.arctan2(direction[0], direction[2])
    element = ElementTree.SubElement(link, "visual")
    _add_origin(element, (start + end) / 2, _numbers((roll, pitch, 0.0)))
    geometry = ElementTree.SubElement(element, "geometry")
    ElementTree.SubElement(
        geometry, "cylinder", radius=repr(shape.radius_m), length=repr(length)
    )


def _add_joint(robot: Element, joint: Joint, parent: str) -> Element:
    element = ElementTree.SubElement(robot, "joint", name=joint.name, type="revolute")
    ElementTree.SubElement(element, "parent", link=parent)
    ElementTree.SubElement(element, "child", link=joint.link.name)
    _add_origin(element, joint.origin_m)
    ElementTree.SubElement(element, "axis", xyz=_numbers(joint.axis))
    lower, upper = joint.range_rad
    ElementTree.SubElement(
        element,
        "limit",
        lower=repr(lower),
        upper=repr(upper),
        effort=repr(joint.motor.stall_torque_nm),
        velocity=repr(joint.motor.no_load_speed_rad_s),
    )
    return element
