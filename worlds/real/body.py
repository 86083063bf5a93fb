"""One robot and its ground in a PyBullet client, moved by joint torques."""

import contextlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from robots.sole import sensor_shares
from terrain import Heightfield
from worlds.real.ground import load_ground
from worlds.soft_ground import FootSpring, soften_bullet

_GEAR_NM, _GEAR_ERP = 1e3, 0.2
"""Largest torque [N m] of PyBullet's gear between two joints of one motor, and the
part of their angle error that it corrects in a physics step: stiff enough to keep the
joints together, soft enough for PyBullet's solver."""


@contextlib.contextmanager
def silent() -> Iterator[None]:
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


def import_bullet() -> Any:
    """Import the module `pybullet` without the banner that it prints from C."""
    with silent():
        import pybullet
    return pybullet


@dataclass(frozen=True, eq=False)
class BodySetup:
    """Everything that a PyBullet client needs to load one robot and its ground.

    Attributes:
      urdf: text of the robot's URDF; besides the base, a link for each joint.
      joints: names of the joints, in the order of all arrays.
      floating: whether the base can move.
      step_s: physics step.
      gravity_m_s2: (3,) gravity in the world frame, which may be tilted.
      friction: coefficient between soles and ground.
      description: gives the feet, the inertial sensor and the joints that share a
        motor; None for a robot without them, such as an arm.
      springs: soft ground under a whole foot; the last one applies, empty for hard.
      ground: the ground under a floating robot; None for no ground.
    """

    urdf: str
    joints: Sequence[str]
    floating: bool
    step_s: float
    gravity_m_s2: FloatArray
    friction: float
    description: Description | None
    springs: Sequence[FootSpring] = ()
    ground: Heightfield | None = None


class BulletBody:
    """One robot and its ground in a PyBullet client of its own, moved by joint torques.

    Attributes:
      setup: the robot and ground that were loaded.
      client: the keyword argument `physicsClientId` of PyBullet's functions, as a dict.
      number: PyBullet's id of the robot.
      position_rad, velocity_rad_s: (joints,) state of the joints after the last step.
    """

    def __init__(self, setup: BodySetup) -> None:
        """Connect a PyBullet client, and load the robot and its ground into it."""
        self._bullet = bullet = import_bullet()
        self.setup = setup
        self.client = {"physicsClientId": bullet.connect(bullet.DIRECT)}
        bullet.setGravity(*setup.gravity_m_s2.tolist(), **self.client)
        bullet.setTimeStep(setup.step_s, **self.client)
        self.number = self._load()
        self._name_parts()
        self._make_passive()
        self._couple()
        for spring in setup.springs:
            if setup.description is not None:
                links = self._links
                soften_bullet(
                    bullet, self.client, self.number, links, setup.description, spring
                )
        if setup.ground is not None:
            floor = load_ground(self.client["physicsClientId"], setup.ground)
            bullet.changeDynamics(
                floor, -1, lateralFriction=1.0, restitution=0.0, **self.client
            )
        place, turn = bullet.getDynamicsInfo(self.number, -1, **self.client)[3:5]
        self._com_m, self._principal = np.array(place), turn

    def _load(self) -> int:
        with tempfile.TemporaryDirectory() as folder, silent():
            path = Path(folder, "robot.urdf")
            path.write_text(self.setup.urdf)
            return int(
                self._bullet.loadURDF(
                    str(path),
                    useFixedBase=not self.setup.floating,
                    flags=self._bullet.URDF_USE_INERTIA_FROM_FILE,
                    **self.client,
                )
            )

    def _name_parts(self) -> None:
        """Look up PyBullet's indices of joints and links by name; the base's is -1."""
        bullet, client = self._bullet, self.client
        count = bullet.getNumJoints(self.number, **client)
        rows = [bullet.getJointInfo(self.number, i, **client) for i in range(count)]
        number = {row[1].decode(): int(row[0]) for row in rows}
        self._links = [number[name] for name in self.setup.joints]
        self._link_of = {row[12].decode(): int(row[0]) for row in rows}
        base = bullet.getBodyInfo(self.number, **client)[0].decode()
        self._link_of[base] = -1

    def _make_passive(self) -> None:
        """Switch off PyBullet's default damping and joint motors; set the friction."""
        bullet, client = self._bullet, self.client
        for link in (-1, *self._links):
            bullet.changeDynamics(
                self.number,
                link,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                lateralFriction=self.setup.friction,
                spinningFriction=0,
                rollingFriction=0,
                restitution=0,
                **client,
            )
        # Bullet's joints come with velocity motors that hold them still.
        still = [0] * len(self._links)
        bullet.setJointMotorControlArray(
            self.number, self._links, bullet.VELOCITY_CONTROL, forces=still, **client
        )

    def _couple(self) -> None:
        """Keep joints that share a motor at the same angle, with a PyBullet gear."""
        description = self.setup.description
        for first, second in description.coupled if description else ():
            gear = self._bullet.createConstraint(
                parentBodyUniqueId=self.number,
                parentLinkIndex=self._links[first],
                childBodyUniqueId=self.number,
                childLinkIndex=self._links[second],
                jointType=self._bullet.JOINT_GEAR,
                jointAxis=[0, 1, 0],
                parentFramePosition=[0] * 3,
                childFramePosition=[0] * 3,
                **self.client,
            )
            self._bullet.changeConstraint(
                gear, gearRatio=-1, maxForce=_GEAR_NM, erp=_GEAR_ERP, **self.client
            )

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest, a floating base upright above the world's origin.

        Args:
          pose_rad: (joints,) joint positions.
          height_m: height of the torso frame above the origin; unused on a fixed base.
        """
        if self.setup.floating:
            place = self._com_m + np.array([0, 0, height_m])
            self._bullet.resetBasePositionAndOrientation(
                self.number, place.tolist(), self._principal, **self.client
            )
            self._bullet.resetBaseVelocity(self.number, [0] * 3, [0] * 3, **self.client)
        for link, angle in zip(self._links, pose_rad.tolist(), strict=True):
            self._bullet.resetJointState(self.number, link, angle, 0.0, **self.client)
        self._read()

    def step(self, torque_nm: FloatArray) -> None:
        """Advance one physics step under torques (joints,) and the preceding pushes."""
        bullet, client = self._bullet, self.client
        bullet.setJointMotorControlArray(
            self.number,
            self._links,
            bullet.TORQUE_CONTROL,
            forces=torque_nm.tolist(),
            **client,
        )
        bullet.stepSimulation(**client)
        self._read()

    def _read(self) -> None:
        states = self._bullet.getJointStates(self.number, self._links, **self.client)
        self.position_rad = np.array([state[0] for state in states])
        self.velocity_rad_s = np.array([state[1] for state in states])

    def push(self, body: str, force_n: FloatArray) -> None:
        """Push a link at its centre of mass (3,) [N, world frame] in the next step."""
        link = self._link_of[body]
        bullet, client = self._bullet, self.client
        if link < 0:
            place = bullet.getBasePositionAndOrientation(self.number, **client)[0]
        else:
            place = self._link(link)[0]
        bullet.applyExternalForce(
            self.number, link, force_n.tolist(), place, bullet.WORLD_FRAME, **client
        )

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a link's centre of mass in the world frame [m/s]."""
        link = self._link_of[body]
        if link < 0:
            return np.array(self._bullet.getBaseVelocity(self.number, **self.client)[0])
        return np.array(self._link(link)[6])

    def _link(self, link: int) -> Any:
        return self._bullet.getLinkState(
            self.number,
            link,
            computeLinkVelocity=1,
            computeForwardKinematics=1,
            **self.client,
        )

    def base_motion(self) -> tuple[FloatArray, FloatArray]:
        """Pose (7,) and velocity (6,) of the torso frame.

        PyBullet gives those of the torso's centre of mass and principal axes instead;
        they are converted here.

        Returns:
          Position [m] and quaternion w, x, y, z; linear velocity [m/s] in the world
          frame and angular velocity [rad/s] in the torso frame.
        """
        bullet, client = self._bullet, self.client
        place, turn = bullet.getBasePositionAndOrientation(self.number, **client)
        linear, angular = bullet.getBaseVelocity(self.number, **client)
        x, y, z, w = self._principal
        turn = bullet.multiplyTransforms([0] * 3, turn, [0] * 3, [-x, -y, -z, w])[1]
        torso = self._rotation(turn)
        arm, spin = torso @ self._com_m, np.array(angular)
        origin = np.array(linear) - _cross(spin, arm)
        pose = np.array([*(np.array(place) - arm), turn[3], *turn[:3]])
        return pose, np.concatenate([origin, torso.T @ spin])

    def specific_force(
        self, pose: FloatArray, before: FloatArray, now: FloatArray, seconds: float
    ) -> FloatArray:
        """(3,) noiseless reading of the accelerometer in the torso frame [m/s^2].

        Args:
          pose: (7,) current pose of the torso, as `base_motion` gives it.
          before: (6,) velocity of the torso, some steps ago.
          now: (6,) current velocity of the torso.
          seconds: time between both velocities.
        """
        description = self.setup.description
        lever = np.zeros(3)
        if description is not None:
            lever = np.array(description.imu.accelerometer_m)
        torso = self._rotation([*pose[4:], pose[3]])
        change, spin = (now - before) / seconds, now[3:]
        linear = torso.T @ (change[:3] - self.setup.gravity_m_s2)
        turning = _cross(change[3:], lever) + _cross(spin, _cross(spin, lever))
        return np.asarray(linear + turning)

    def foot_forces(self) -> FloatArray:
        """(8,) forces on the foot sensors in the last step [N], left foot first.

        A contact beyond the sensors of a foot can make a force negative.
        """
        forces = np.zeros((2, 4))
        description = self.setup.description
        for side, foot in enumerate(description.feet if description else ()):
            link = self._links[foot.joint]
            contacts = self._bullet.getContactPoints(
                bodyA=self.number, linkIndexA=link, **self.client
            )
            if not contacts:
                continue
            state = self._link(link)
            away_m = np.array([contact[5] for contact in contacts]) - state[4]
            points_m = away_m @ self._rotation(state[5])
            normal_n = np.array([contact[9] for contact in contacts])
            forces[side] = normal_n @ sensor_shares(foot.sensors_m, points_m[:, :2])
        return forces.ravel()

    def _rotation(self, quaternion_xyzw: Any) -> FloatArray:
        flat = self._bullet.getMatrixFromQuaternion(quaternion_xyzw)
        return np.array(flat).reshape(3, 3)

    def close(self) -> None:
        """Disconnect the PyBullet client; the robot cannot be used afterwards."""
        self._bullet.disconnect(**self.client)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The cross product of two (3,) vectors; NumPy's own costs ten times as much."""
    ax, ay, az = a
    bx, by, bz = b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
