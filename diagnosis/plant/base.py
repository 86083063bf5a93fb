"""Changes how a robot model is held: a fixed or floating base, and locked joints."""

from typing import Any

import mujoco
import numpy as np

from diagnosis.plant.plant import ROOT, Base
from groundwalk.errors import BadModelError

_LEVEL_M = 0.02
"""A body reaching down to at most this [m] above the lowest one counts as a foot."""


def set_base(spec: mujoco.MjSpec, base: Base) -> None:
    """Weld the base to the world, without contacts, or let it float above a ground.

    For a floating base, a model without a free joint gets one at its only body under
    the world, and a model without a ground gets a plane.

    Raises:
      BadModelError: the base is to float, but several bodies are under the world, none
        is, or a joint other than a free one holds it.
    """
    free = [
        joint
        for joint in spec.joints
        if joint.type == mujoco.mjtJoint.mjJNT_FREE
        and joint.parent.parent == spec.worldbody
    ]
    if base == "fixed":
        for joint in free:
            spec.delete(joint)
        spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        return
    if free:
        free[0].name = ROOT
    else:
        _root_body(spec).add_freejoint(name=ROOT)
    _add_ground(spec)


def lock_joints(spec: mujoco.MjSpec, free: set[str]) -> None:
    """Remove all joints but those in `free`, as if they were locked at position 0.

    A body whose joint is removed becomes part of the body that carries it. Equalities,
    tendons and sensors of the model that refer to a removed joint are removed, too.
    """
    locked = [joint for joint in spec.joints if joint.name not in free]
    names = {joint.name for joint in locked}
    for equality in list(spec.equalities):
        if names & {equality.name1, equality.name2}:
            spec.delete(equality)
    for tendon in list(spec.tendons):
        wrapped = (wrap.target for wrap in tendon.path)
        if any(target is not None and target.name in names for target in wrapped):
            spec.delete(tendon)
    for sensor in list(spec.sensors):
        if sensor.objtype == mujoco.mjtObj.mjOBJ_JOINT and sensor.objname in names:
            spec.delete(sensor)
    for joint in locked:
        spec.delete(joint)
    spec.compiler.fusestatic = True


def standing_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the bodies taken as feet, left before right.

    With all joints at zero they reach lowest, to within 2 cm, of all bodies that carry
    no other body and have shapes that can touch something.
    """
    data = mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    parents = set(model.body_parentid[1:].tolist())
    lowest: dict[int, float] = {}
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        touches = model.geom_contype[geom] or model.geom_conaffinity[geom]
        if touches and body > 0 and body not in parents:
            bottom = _bottom(model, data, geom)
            lowest[body] = min(bottom, lowest.get(body, np.inf))
    level = min(lowest.values(), default=0.0) + _LEVEL_M
    feet = [body for body, bottom in lowest.items() if bottom <= level]
    feet.sort(key=lambda body: -data.xpos[body, 1])
    return tuple(model.body(body).name for body in feet)


def _bottom(model: mujoco.MjModel, data: Any, geom: int) -> float:
    """Height of the lowest corner of a shape's bounding box [m]."""
    centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
    down = data.geom_xmat[geom].reshape(3, 3)[2]
    return float(data.geom_xpos[geom, 2] + down @ centre - np.abs(down) @ half)


def _root_body(spec: mujoco.MjSpec) -> Any:
    bodies = spec.worldbody.bodies
    if len(bodies) != 1:
        names = ", ".join(body.name for body in bodies)
        raise BadModelError(
            "a floating base needs one body under the world; here are: "
            f"{names or 'none'}"
        )
    if bodies[0].joints:
        raise BadModelError(
            f"{bodies[0].name} is to float, but it has the joint "
            f"{bodies[0].joints[0].name!r} to the world"
        )
    return bodies[0]


def _add_ground(spec: mujoco.MjSpec) -> None:
    grounds = (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD)
    if any(geom.type in grounds for geom in spec.worldbody.geoms):
        return
    spec.worldbody.add_geom(
        name="ground",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0, 0, 1],
        contype=0,
        conaffinity=1,
    )
