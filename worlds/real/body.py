"""One robot and its ground in a PyBullet client, moved by joint torques."""

import contextlib
import math
import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from robots.sole import contact_points, sensor_shares
from terrain import Heightfield
from worlds.soft_ground import FootSpring

_GEAR_NM, _GEAR_ERP = 1e3, 0.2
"""Largest torque [N m] of PyBullet's gear between two joints of one motor, and the
part of their angle error that it corrects in a physics step: stiff enough to keep the
joints together, soft enough for PyBullet's solver."""


@contextlib.contextmanager
def _silent() -> Iterator[None]:
    """Discard output to stdout and stderr in a `with` block, that of C code as well."""
    kept = [os.dup(1), os.dup(2)]
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        for stream, copy in enumerate(kept, start=1):
            os.dup2(copy, stream)
            os.close(copy)


def bullet_client() -> Any:
    """A new PyBullet client, without graphics, with PyBullet's functions as methods."""
    with _silent():  # PyBullet prints as it is imported, and as it connects
        import pybullet
        from pybullet_utils.bullet_client import BulletClient

        return BulletClient(pybullet.DIRECT)


class BulletBody:
    """One robot and its ground in a PyBullet client of its own, moved by joint torques.

    `bullet` is the client, `number` its id of the robot. The joints' positions and
    velocities (joints,) are those after the last step.
    """

    def __init__(
        self,
        urdf: str,
        joints: Sequence[str],
        description: Description | None,
        *,
        floating: bool,
        step_s: float,
        gravity_m_s2: FloatArray,
        friction: float,
        spring: FootSpring | None,
        ground: Heightfield | None,
    ) -> None:
        """Connect a PyBullet client, and load the robot and its ground into it.

        Besides the base, `urdf` (text) has a link for each of the `joints`, whose order
        is that of all arrays. The description gives feet, inertial sensor and joints
        that share a motor; None for a robot without them. Gravity (3,) may be tilted.
        `friction` acts between soles and ground, `spring` is soft ground under a whole
        foot.
        """
        self.bullet = bullet = bullet_client()
        self._description, self._floating = description, floating
        self._gravity_m_s2, self._step_s = gravity_m_s2, step_s
        bullet.setGravity(*gravity_m_s2.tolist())
        bullet.setTimeStep(step_s)
        self.number = self._load(urdf)
        self._name_parts(joints)
        self._make_passive(friction)
        if description is not None:
            self._couple(description)
            if spring is not None:
                self._soften(description, spring)
        if ground is not None:
            floor = load_ground(bullet, ground)
            bullet.changeDynamics(floor, -1, lateralFriction=1.0, restitution=0.0)
        place, turn = bullet.getDynamicsInfo(self.number, -1)[3:5]
        self._com_m, self._principal = np.array(place), turn

    def _load(self, urdf: str) -> int:
        with tempfile.TemporaryDirectory() as folder, _silent():
            path = Path(folder, "robot.urdf")
            path.write_text(urdf)
            flags = self.bullet.URDF_USE_INERTIA_FROM_FILE
            fixed = not self._floating
            return int(self.bullet.loadURDF(str(path), useFixedBase=fixed, flags=flags))

    def _name_parts(self, joints: Sequence[str]) -> None:
        """Look up PyBullet's indices of joints and links by name; the base's is -1."""
        count = self.bullet.getNumJoints(self.number)
        rows = [self.bullet.getJointInfo(self.number, i) for i in range(count)]
        number = {row[1].decode(): int(row[0]) for row in rows}
        self._links = [number[name] for name in joints]
        self._link_of = {row[12].decode(): int(row[0]) for row in rows}
        self._link_of[self.bullet.getBodyInfo(self.number)[0].decode()] = -1

    def _make_passive(self, friction: float) -> None:
        """Switch off PyBullet's default damping and joint motors; set the friction."""
        for link in (-1, *self._links):
            self.bullet.changeDynamics(
                self.number,
                link,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                lateralFriction=friction,
                spinningFriction=0,
                rollingFriction=0,
                restitution=0,
            )
        # Bullet's joints come with velocity motors that hold them still.
        self._drive(self.bullet.VELOCITY_CONTROL, [0] * len(self._links))

    def _drive(self, mode: int, forces: Sequence[float]) -> None:
        """Set what drives the joints from now on: torques, or forces of motors."""
        self.bullet.setJointMotorControlArray(
            self.number, self._links, mode, forces=forces
        )

    def _couple(self, description: Description) -> None:
        """Keep joints that share a motor at the same angle, with a PyBullet gear."""
        for first, second in description.coupled:
            gear = self.bullet.createConstraint(
                parentBodyUniqueId=self.number,
                parentLinkIndex=self._links[first],
                childBodyUniqueId=self.number,
                childLinkIndex=self._links[second],
                jointType=self.bullet.JOINT_GEAR,
                jointAxis=[0, 1, 0],
                parentFramePosition=[0] * 3,
                childFramePosition=[0] * 3,
            )
            self.bullet.changeConstraint(
                gear, gearRatio=-1, maxForce=_GEAR_NM, erp=_GEAR_ERP
            )

    def _soften(self, description: Description, spring: FootSpring) -> None:
        """Give the soles soft contacts; a foot's contact points share its spring."""
        for foot in description.feet:
            points = len(contact_points(foot))
            self.bullet.changeDynamics(
                self.number,
                self._links[foot.joint],
                contactStiffness=spring.stiffness_n_m / points,
                contactDamping=spring.damping_n_s_m / points,
            )

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest in a pose (joints,), a floating base at this height."""
        if self._floating:
            place = self._com_m + np.array([0, 0, height_m])
            self.bullet.resetBasePositionAndOrientation(
                self.number, place.tolist(), self._principal
            )
            self.bullet.resetBaseVelocity(self.number, [0] * 3, [0] * 3)
        for link, angle in zip(self._links, pose_rad.tolist(), strict=True):
            self.bullet.resetJointState(self.number, link, angle, 0.0)
        self._read()

    def step(self, torque_nm: FloatArray) -> None:
        """Advance one physics step under torques (joints,) and the preceding pushes."""
        self._drive(self.bullet.TORQUE_CONTROL, torque_nm.tolist())
        self.bullet.stepSimulation()
        self._read()

    def _read(self) -> None:
        states = self.bullet.getJointStates(self.number, self._links)
        self.position_rad = np.array([state[0] for state in states])
        self.velocity_rad_s = np.array([state[1] for state in states])

    def push(self, body: str, force_n: FloatArray) -> None:
        """Push a link at its centre of mass (3,) [N, world frame] in the next step."""
        link, bullet = self._link_of[body], self.bullet
        if link < 0:
            place = bullet.getBasePositionAndOrientation(self.number)[0]
        else:
            place = self._link(link)[0]
        bullet.applyExternalForce(
            self.number, link, force_n.tolist(), place, bullet.WORLD_FRAME
        )

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a link's centre of mass in the world frame [m/s]."""
        link = self._link_of[body]
        if link < 0:
            return np.array(self.bullet.getBaseVelocity(self.number)[0])
        return np.array(self._link(link)[6])

    def _link(self, link: int) -> Any:
        return self.bullet.getLinkState(
            self.number, link, computeLinkVelocity=1, computeForwardKinematics=1
        )

    def base_motion(self) -> tuple[FloatArray, FloatArray]:
        """Pose (7,) and velocity (6,) of the torso frame, as `BodySense` has them.

        PyBullet's own are those of the torso's centre of mass and principal axes.
        """
        place, turn = self.bullet.getBasePositionAndOrientation(self.number)
        linear, angular = self.bullet.getBaseVelocity(self.number)
        x, y, z, w = self._principal
        back = [-x, -y, -z, w]
        turn = self.bullet.multiplyTransforms([0] * 3, turn, [0] * 3, back)[1]
        torso = self._rotation(turn)
        arm, spin = torso @ self._com_m, np.array(angular)
        origin = np.array(linear) - _cross(spin, arm)
        pose = np.array([*(np.array(place) - arm), turn[3], *turn[:3]])
        return pose, np.concatenate([origin, torso.T @ spin])

    def specific_force(
        self, pose: FloatArray, before: FloatArray, now: FloatArray, seconds: float
    ) -> FloatArray:
        """(3,) noiseless reading of the accelerometer in the torso frame [m/s^2].

        It follows from the pose now, and the velocities of `base_motion` now and some
        seconds before.
        """
        lever = np.zeros(3)
        if self._description is not None:
            lever = np.array(self._description.imu.accelerometer_m)
        torso = self._rotation([*pose[4:], pose[3]])
        change, spin = (now - before) / seconds, now[3:]
        linear = torso.T @ (change[:3] - self._gravity_m_s2)
        turning = _cross(change[3:], lever) + _cross(spin, _cross(spin, lever))
        return np.asarray(linear + turning)

    def foot_forces(self) -> FloatArray:
        """(8,) forces on the foot sensors in the last step [N], left foot first.

        A contact beyond the sensors of a foot can make a force negative.
        """
        forces = np.zeros((2, 4))
        feet = self._description.feet if self._description else ()
        for side, foot in enumerate(feet):
            link = self._links[foot.joint]
            contacts = self.bullet.getContactPoints(bodyA=self.number, linkIndexA=link)
            if not contacts:
                continue
            state = self._link(link)
            away_m = np.array([contact[5] for contact in contacts]) - state[4]
            points_m = away_m @ self._rotation(state[5])
            normal_n = np.array([contact[9] for contact in contacts])
            forces[side] = normal_n @ sensor_shares(foot.sensors_m, points_m[:, :2])
        return forces.ravel()

    def _rotation(self, quaternion_xyzw: Any) -> FloatArray:
        flat = self.bullet.getMatrixFromQuaternion(quaternion_xyzw)
        return np.array(flat).reshape(3, 3)

    def close(self) -> None:
        """Disconnect the PyBullet client; the robot cannot be used afterwards."""
        self.bullet.disconnect()


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The cross product of two (3,) vectors; NumPy's own costs ten times as much."""
    ax, ay, az = a
    bx, by, bz = b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


_QUARTER_TURN = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
"""Quaternion x, y, z, w of a turn by +90 degrees about the vertical."""


def load_ground(bullet: Any, field: Heightfield) -> int:
    """Load ground into a client of PyBullet as a static body; returns the body's id.

    PyBullet cuts a cell of a heightfield into triangles along the diagonal from
    [row, column + 1] to [row + 1, column], MuJoCo and `Heightfield` along the other
    one. So the samples are turned by -90 degrees and the body by +90: heights stay in
    place, diagonals change. PyBullet counts samples along its x axis as "rows" and puts
    the middle between the lowest and the highest sample at the body's origin. Ray casts
    agree with `field.height_at` to 1e-8 m.
    """
    (x_low, x_high), (y_low, y_high) = field.x_range_m, field.y_range_m
    lowest_m, highest_m = float(field.heights_m.min()), float(field.heights_m.max())
    middle = (
        (x_low + x_high) / 2.0,
        (y_low + y_high) / 2.0,
        (lowest_m + highest_m) / 2.0,
    )
    if field.is_flat:
        up = (0.0, 0.0, 1.0)
        plane = bullet.createCollisionShape(bullet.GEOM_PLANE, planeNormal=up)
        return int(bullet.createMultiBody(0.0, plane, basePosition=middle))
    turned_m = np.rot90(field.heights_m)
    shape = bullet.createCollisionShape(
        bullet.GEOM_HEIGHTFIELD,
        meshScale=(field.spacing_m, field.spacing_m, 1.0),
        heightfieldData=turned_m.ravel().tolist(),
        numHeightfieldRows=turned_m.shape[1],
        numHeightfieldColumns=turned_m.shape[0],
        # Without this flag feet stumble over edges between coplanar triangles.
        flags=bullet.GEOM_CONCAVE_INTERNAL_EDGE,
    )
    return int(
        bullet.createMultiBody(
            0.0, shape, basePosition=middle, baseOrientation=_QUARTER_TURN
        )
    )
