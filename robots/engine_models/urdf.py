"""Makes the URDF of a robot from its description.

The only collision shapes are small spheres around the soles, as in the MuJoCo model.
There are no massless links: PyBullet would give each of them 1 kg.
"""

from xml.etree.ElementTree import Element, SubElement

import numpy as np

from robots.description import Capsule, Description, Foot, Joint, Link
from robots.engine_models.urdf_elements import (
    add_hinge,
    add_link,
    add_origin,
    add_sphere,
    numbers,
    text_of,
)
from robots.rigid_body import Inertial
from robots.sole import CONTACT_RADIUS_M, contact_points


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
            SubElement(element, "mimic", joint=description.joints[followers[i]])
    return text_of(robot, declared=True)


def _add_link(
    robot: Element, link: Link, inertial: Inertial, foot: Foot | None
) -> None:
    element = add_link(robot, link.name, inertial)
    for shape in link.shapes:
        _add_capsule(element, shape)
    if foot is not None:
        for x, y in contact_points(foot):
            centre = np.array([x, y, foot.sole_height_m + CONTACT_RADIUS_M])
            add_sphere(element, "collision", centre, CONTACT_RADIUS_M)


def _add_capsule(link: Element, shape: Capsule) -> None:
    """Add a capsule to a link as visual spheres and cylinder; URDF has no capsules."""
    start, end = np.array(shape.start_m), np.array(shape.end_m)
    add_sphere(link, "visual", start, shape.radius_m)
    length = float(np.linalg.norm(end - start))
    if length == 0:
        return
    add_sphere(link, "visual", end, shape.radius_m)
    direction = (end - start) / length
    # roll, pitch, yaw that turn the z axis into the direction, with yaw zero
    roll = -np.arcsin(direction[1])
    pitch = np.arctan2(direction[0], direction[2])
    element = SubElement(link, "visual")
    add_origin(element, (start + end) / 2, numbers((roll, pitch, 0.0)))
    sizes = {"radius": repr(shape.radius_m), "length": repr(length)}
    SubElement(SubElement(element, "geometry"), "cylinder", sizes)


def _add_joint(robot: Element, joint: Joint, parent: str) -> Element:
    effort = repr(joint.motor.stall_torque_nm)
    limit = (*joint.range_rad, effort, repr(joint.motor.no_load_speed_rad_s))
    names = joint.name, parent, joint.link.name
    return add_hinge(robot, names, joint.origin_m, "0 0 0", joint.axis, limit)
