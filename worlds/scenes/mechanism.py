"""Describes any MuJoCo model, such as an arm's, so that its recordings can be shown."""

from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from robots.description import Capsule, Description, Imu, Joint, Link, Motor
from robots.rigid_body import Inertial
from robots.scale import Scale

if TYPE_CHECKING:
    import mujoco

_NAO_EXTENT_M = 0.5
"""Extent [m], the largest along x, y or z, of a mechanism that is drawn at the scale of
a NAO, which is 0.57 m tall; the scale of others is in proportion."""

_LEAST_KG = 1e-9
"""Least mass [kg] of a link: it must be above 0, and pictures need no true masses."""

_THIN = 0.03
"""Radius of the rod drawn for a link without shapes, as a share of the extent."""

_NO_MOTOR = Motor(0.0, 0.0, 0.0, 0.0, 0.0)


def mechanism(model: "mujoco.MjModel", name: str) -> Description:
    """Describe a MuJoCo model without feet for pictures only; no world can step it.

    The model is a tree of hinge and slide joints, with or without a free joint at its
    root. Each of its shapes (geoms) becomes a capsule along its longest side. Links
    without shapes become thin rods from joint to joint.
    """
    import mujoco

    kinds = mujoco.mjtJoint
    slide, hinge = int(kinds.mjJNT_SLIDE), int(kinds.mjJNT_HINGE)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.0  # where all links' frames are parallel
    for joint in np.flatnonzero(model.jnt_type == int(kinds.mjJNT_FREE)):
        data.qpos[model.jnt_qposadr[joint] + 3] = 1.0  # upright
    mujoco.mj_kinematics(model, data)
    joints = np.flatnonzero(np.isin(model.jnt_type, (hinge, slide)))
    parent, mover = _tree(model, joints)
    # Place [m] of each joint; the last row, -1, is the root.
    origin_m = np.vstack([data.xanchor[joints], np.zeros((1, 3))])
    shapes = _shapes(model, data)
    places_m = [np.zeros((1, 3)), data.xanchor, *(ends for _, ends, _ in shapes)]
    extent_m = max(float(np.ptp(np.vstack(places_m), axis=0).max()), 0.01)

    def link(name: str, row: int) -> Link:
        """Link that joint `row` moves: mass and capsules of all bodies on it."""
        mass_kg = max(float(model.body_mass[mover == row].sum()), _LEAST_KG)
        parts = [(ends, radius) for body, ends, radius in shapes if mover[body] == row]
        if not parts:
            after = np.flatnonzero(parent == row)
            rods = [np.stack([origin_m[row], origin_m[k]]) for k in after]
            parts = [(ends, _THIN * extent_m) for ends in rods]
        capsules = [_capsule(ends - origin_m[row], radius) for ends, radius in parts]
        inertial = Inertial(mass_kg, np.zeros(3), np.zeros((3, 3)))
        return Link(name, inertial, tuple(capsules))

    links = [
        Joint(
            name=model.joint(joint).name,
            parent=int(parent[row]),
            origin_m=origin_m[row] - origin_m[parent[row]],
            axis=data.xaxis[joint].copy(),
            range_rad=tuple(model.jnt_range[joint].tolist()),
            motor=_NO_MOTOR,
            link=link(model.joint(joint).name, row),
            slides=bool(model.jnt_type[joint] == slide),
        )
        for row, joint in enumerate(joints)
    ]
    scale = Scale(length=extent_m / _NAO_EXTENT_M)
    imu = Imu((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return Description(name, link("base", -1), tuple(links), (), (), imu, scale)


def _tree(model: "mujoco.MjModel", joints: IntArray) -> tuple[IntArray, IntArray]:
    """Row of the joint before each of the joints, and of the one that moves each body.

    Rows count the joints from the root's side; -1 is the root.
    """
    parent, mover = np.full(len(joints), -1), np.full(model.nbody, -1)
    for body in range(1, model.nbody):
        mover[body] = mover[model.body_parentid[body]]
        for row in np.flatnonzero(model.jnt_bodyid[joints] == body):
            parent[row], mover[body] = mover[body], row
    return parent, mover


def _shapes(
    model: "mujoco.MjModel", data: "mujoco.MjData"
) -> list[tuple[int, FloatArray, float]]:
    """Capsules for geoms but planes: body id, axis ends (2, 3) and radius [m]."""
    import mujoco

    found = []
    for geom in np.flatnonzero(model.geom_type != int(mujoco.mjtGeom.mjGEOM_PLANE)):
        middle, half = model.geom_aabb[geom].reshape(2, 3)
        along = int(half.argmax())
        radius = float(np.delete(half, along).mean())
        way = np.zeros(3)
        way[along] = max(half[along] - radius, 0.0)
        turn = data.geom_xmat[geom].reshape(3, 3)
        ends = data.geom_xpos[geom] + np.array([middle - way, middle + way]) @ turn.T
        found.append((int(model.geom_bodyid[geom]), ends, radius))
    return found


def _capsule(ends_m: FloatArray, radius_m: float) -> Capsule:
    (ax, ay, az), (bx, by, bz) = ends_m.tolist()
    return Capsule((ax, ay, az), (bx, by, bz), radius_m)
