"""Describes any MuJoCo model, such as an arm's, so that its recordings can be shown."""

from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
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

    Each shape (geom) of the model becomes a capsule along its longest side. Links
    without shapes become thin rods from joint to joint.

    Args:
      model: a compiled tree of hinge and slide joints, with or without a free joint
        at its root.
      name: the robot's name.
    """
    return _Mechanism(model).description(name)


class _Mechanism:
    """Makes links from a MuJoCo model with joints at 0, where frames are parallel."""

    def __init__(self, model: "mujoco.MjModel") -> None:
        import mujoco

        self._model, self._data = model, mujoco.MjData(model)
        kinds = mujoco.mjtJoint
        self._slide = int(kinds.mjJNT_SLIDE)
        self._joints = [
            joint
            for joint in range(model.njnt)
            if model.jnt_type[joint] in (int(kinds.mjJNT_HINGE), self._slide)
        ]
        self._data.qpos[:] = 0.0
        for joint in range(model.njnt):
            if model.jnt_type[joint] == int(kinds.mjJNT_FREE):
                self._data.qpos[model.jnt_qposadr[joint] + 3] = 1.0  # upright
        mujoco.mj_kinematics(model, self._data)
        self._shapes = self._geoms()
        places_m = np.vstack(
            [np.zeros((1, 3)), self._data.xanchor, *(c for _, c, _ in self._shapes)]
        )
        self._extent_m = max(float(np.ptp(places_m, axis=0).max()), 0.01)

    def description(self, name: str) -> Description:
        """Make the description: a root link, and a link for each hinge or slide."""
        nowhere = (0.0, 0.0, 0.0)
        return Description(
            name=name,
            root=self._link("base", -1),
            links=tuple(self._joint(row) for row in range(len(self._joints))),
            coupled=(),
            feet=(),
            imu=Imu(nowhere, nowhere),
            scale=Scale(length=self._extent_m / _NAO_EXTENT_M),
        )

    def _geoms(self) -> list[tuple[int, FloatArray, float]]:
        """Capsules for geoms but planes: body id, axis ends (2, 3) and radius [m]."""
        import mujoco

        model, data, found = self._model, self._data, []
        for geom in range(model.ngeom):
            if model.geom_type[geom] == int(mujoco.mjtGeom.mjGEOM_PLANE):
                continue
            middle, half = model.geom_aabb[geom].reshape(2, 3)
            along = int(half.argmax())
            radius = float(np.delete(half, along).mean())
            way = np.zeros(3)
            way[along] = max(half[along] - radius, 0.0)
            turn = data.geom_xmat[geom].reshape(3, 3)
            ends = (
                data.geom_xpos[geom] + np.array([middle - way, middle + way]) @ turn.T
            )
            found.append((int(model.geom_bodyid[geom]), ends, radius))
        return found

    def _joint(self, row: int) -> Joint:
        joint = self._joints[row]
        parent = self._carrier(row)
        way_m = self._origin_m(row) - self._origin_m(parent)
        low, high = self._model.jnt_range[joint].tolist()
        name = self._model.joint(joint).name
        return Joint(
            name=name,
            parent=parent,
            origin_m=way_m,
            axis=self._data.xaxis[joint].copy(),
            range_rad=(low, high),
            motor=_NO_MOTOR,
            link=self._link(name, row),
            slides=bool(self._model.jnt_type[joint] == self._slide),
        )

    def _origin_m(self, row: int) -> FloatArray:
        """(3,) place [m] of a joint in the world; the origin for -1, the root."""
        if row < 0:
            return np.zeros(3)
        return np.array(self._data.xanchor[self._joints[row]])

    def _carrier(self, row: int) -> int:
        """Row of the joint before joint `row` on the path from the root, or -1."""
        body = int(self._model.jnt_bodyid[self._joints[row]])
        before = [k for k in range(row) if self._body(k) == body]
        return before[-1] if before else self._mover(self._model.body_parentid[body])

    def _mover(self, body: int) -> int:
        """Row of the last joint between the root and a MuJoCo body, or -1."""
        while body > 0:
            own = [row for row in range(len(self._joints)) if self._body(row) == body]
            if own:
                return own[-1]
            body = int(self._model.body_parentid[body])
        return -1

    def _body(self, row: int) -> int:
        return int(self._model.jnt_bodyid[self._joints[row]])

    def _link(self, name: str, row: int) -> Link:
        """Link that joint `row` moves: mass and capsules of all bodies on it."""
        model, origin_m = self._model, self._origin_m(row)
        bodies = [body for body in range(model.nbody) if self._mover(body) == row]
        mass_kg = max(float(model.body_mass[bodies].sum()), _LEAST_KG)
        inertial = Inertial(mass_kg, np.zeros(3), np.zeros((3, 3)))
        parts = [
            (ends, radius) for body, ends, radius in self._shapes if body in bodies
        ]
        if not parts:
            parts = [
                (np.array([origin_m, self._origin_m(other)]), _THIN * self._extent_m)
                for other in range(len(self._joints))
                if self._carrier(other) == row
            ]
        shapes = [_capsule(ends - origin_m, radius) for ends, radius in parts]
        return Link(name, inertial, tuple(shapes))


def _capsule(ends_m: FloatArray, radius_m: float) -> Capsule:
    (ax, ay, az), (bx, by, bz) = ends_m.tolist()
    return Capsule((ax, ay, az), (bx, by, bz), radius_m)
