"""URDFs of a robot, from its description or from a compiled MuJoCo model.

PyBullet and MuJoCo read them alike. A description's only collision shapes are small
spheres around the soles, as in the MuJoCo model. There are no massless links, and of a
model only moving bodies become links: PyBullet would give each massless link 1 kg.
"""

from collections.abc import Iterable
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Capsule, Description, Foot, Link
from robots.rigid_body import Inertial
from robots.sole import CONTACT_RADIUS_M, contact_points

if TYPE_CHECKING:
    import mujoco


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
    """Add a sphere at (3,) [m] to a link; `kind` is "visual" or "collision"."""
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

    `names` are those of the joint, of the link that carries it and of the link it
    moves, `place_m` (3,) and `rpy` (roll, pitch, yaw [rad]) place the latter in the
    former, `axis` is in the moved link's frame, and `limit` holds lower and upper end
    [rad], largest torque [N m] and speed [rad/s].
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
        motor = joint.motor
        limit = (
            *joint.range_rad,
            repr(motor.stall_torque_nm),
            repr(motor.no_load_speed_rad_s),
        )
        names = joint.name, parent.name, joint.link.name
        element = add_hinge(robot, names, joint.origin_m, "0 0 0", joint.axis, limit)
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


BASE = "base"
_LIMIT_RAD_S = "100"


def model_urdf(
    model: "mujoco.MjModel",
    name: str,
    rotor_kg_m2: float | FloatArray = 0.0,
    effort_nm: float | FloatArray = 1000.0,
) -> str:
    """Make URDF text of a model's moving bodies, hinges and collision spheres.

    The model is a tree of hinges, on a fixed base or with a free joint as its first.
    The rotor inertia is lumped into each link; `effort_nm` is the limit stated for each
    joint. Both are one number for all joints, or (njnt,), in the model's order.
    """
    import mujoco

    rotors = np.broadcast_to(rotor_kg_m2, model.njnt).tolist()
    efforts = np.broadcast_to(effort_nm, model.njnt).tolist()

    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    robot = Element("robot", name=name)
    hinges = range(model.njnt)
    if model.njnt and model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE:
        hinges, root = hinges[1:], int(model.jnt_bodyid[0])
        _add_body(robot, model, root, _inertial(model, root))
    else:
        SubElement(robot, "link", name=BASE)
    for joint in hinges:
        body = int(model.jnt_bodyid[joint])
        inertial = _inertial(model, body).with_rotor(
            model.jnt_axis[joint], rotors[joint]
        )
        _add_body(robot, model, body, inertial)
    for joint in hinges:
        _add_joint(robot, model, data, joint, efforts[joint])
    return text_of(robot, declared=False)


def _inertial(model: "mujoco.MjModel", body: int) -> Inertial:
    turn = _matrix(model.body_iquat[body])
    inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
    return Inertial(float(model.body_mass[body]), model.body_ipos[body].copy(), inertia)


def _matrix(quaternion: FloatArray) -> FloatArray:
    import mujoco

    flat = np.zeros(9)
    mujoco.mju_quat2Mat(flat, quaternion)
    return flat.reshape(3, 3)


def _add_body(
    robot: Element, model: "mujoco.MjModel", body: int, inertial: Inertial
) -> None:
    import mujoco

    link = add_link(robot, model.body(body).name, inertial)
    is_sphere = model.geom_type == mujoco.mjtGeom.mjGEOM_SPHERE
    of_body = (model.geom_bodyid == body) & (model.geom_contype != 0) & is_sphere
    for geom in np.flatnonzero(of_body):
        radius_m = float(model.geom_size[geom, 0])
        add_sphere(link, "collision", model.geom_pos[geom], radius_m)


def _add_joint(
    robot: Element,
    model: "mujoco.MjModel",
    data: "mujoco.MjData",
    joint: int,
    effort_nm: float,
) -> None:
    body = int(model.jnt_bodyid[joint])
    parent = int(model.body_parentid[body])
    place, turn = model.body_pos[body], _matrix(model.body_quat[body])
    above = model.body(parent).name
    if model.body_weldid[parent] == 0:
        above, world = BASE, data.xmat[parent].reshape(3, 3)
        place, turn = data.xpos[parent] + world @ place, world @ turn
    names = model.joint(joint).name, above, model.body(body).name
    lower, upper = model.jnt_range[joint].tolist()
    limit = lower, upper, repr(effort_nm), _LIMIT_RAD_S
    rpy = numbers(_roll_pitch_yaw(turn))
    add_hinge(robot, names, place, rpy, model.jnt_axis[joint], limit)


def _roll_pitch_yaw(turn: FloatArray) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a (3, 3) rotation, about fixed x, y and z axes."""
    pitch = float(np.arcsin(np.clip(-turn[2, 0], -1.0, 1.0)))
    if abs(turn[2, 0]) > 1 - 1e-12:
        return float(np.arctan2(-turn[1, 2], turn[1, 1])), pitch, 0.0
    roll = float(np.arctan2(turn[2, 1], turn[2, 2]))
    return roll, pitch, float(np.arctan2(turn[1, 0], turn[0, 0]))
