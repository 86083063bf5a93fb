"""Converts a compiled MuJoCo model to a URDF that PyBullet and MuJoCo read alike.

Only moving bodies become links, because PyBullet would give a massless link 1 kg.
"""

from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from groundwalk.arrays import FloatArray
from robots.engine_models.urdf import (
    add_hinge,
    add_link,
    add_sphere,
    numbers,
    text_of,
)
from robots.rigid_body import Inertial

if TYPE_CHECKING:
    import mujoco

BASE = "base"
_LIMIT_RAD_S = "100"


def model_urdf(
    model: "mujoco.MjModel",
    name: str,
    rotor_kg_m2: float = 0.0,
    effort_nm: float = 1000.0,
) -> str:
    """Make URDF text of a model's moving bodies, hinges and collision spheres.

    The model is a tree of hinges, on a fixed base or with a free joint as its first.
    The rotor inertia is lumped into each link; `effort_nm` is the limit stated for each
    joint.
    """
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    robot = Element("robot", name=name)
    hinges = range(model.njnt)
    if model.njnt and model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE:
        hinges, root = hinges[1:], int(model.jnt_bodyid[0])
        _add_link(robot, model, root, _inertial(model, root))
    else:
        SubElement(robot, "link", name=BASE)
    for joint in hinges:
        body = int(model.jnt_bodyid[joint])
        inertial = _inertial(model, body).with_rotor(model.jnt_axis[joint], rotor_kg_m2)
        _add_link(robot, model, body, inertial)
    for joint in hinges:
        _add_joint(robot, model, data, joint, effort_nm)
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


def _add_link(
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
