"""One robot in one PyBullet client."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description
from robots.sole import sensor_shares
from robots.urdf import urdf
from terrain import Heightfield
from worlds.real.gear import couple
from worlds.real.ground import load_ground
from worlds.real.servo_twin import ServoTwin
from worlds.soft_ground import FootSpring, soften_bullet
from worlds.world import WorldOptions

_OUT_OF_REACH_M = 100.0


@dataclass(frozen=True, eq=False)
class BulletState:
    """What one robot's client knows after a tick.

    Attributes:
      base_pose: (7,) torso position [m] and quaternion w, x, y, z.
      base_velocity: (6,) linear [m/s] in the world, angular [rad/s] in the torso frame.
      position_rad, velocity_rad_s: (joints,).
      gyroscope_rad_s: (3,) torso frame.
      accelerometer_m_s2: (3,) torso frame, over the last physics step.
      foot_force_n: (8,) over the last physics step.
    """

    base_pose: FloatArray
    base_velocity: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray
    gyroscope_rad_s: FloatArray
    accelerometer_m_s2: FloatArray
    foot_force_n: FloatArray


class BulletRobot:
    """A robot on its ground, with the sim's motors (`ServoTwin`)."""

    def __init__(
        self, description: Description, ground: Heightfield, options: WorldOptions
    ) -> None:
        """Connect a client of its own and load robot and ground."""
        import pybullet

        self._bullet = pybullet
        self._description = description
        self._options = options
        self._client = {"physicsClientId": pybullet.connect(pybullet.DIRECT)}
        pybullet.setGravity(0, 0, -GRAVITY_M_S2, **self._client)
        pybullet.setTimeStep(options.timestep_s, **self._client)
        self._body = self._load_robot()
        self._links = list(range(len(description.joints)))
        if not options.fixed_base:
            body = load_ground(self._client["physicsClientId"], ground)
            pybullet.changeDynamics(
                body, -1, lateralFriction=1.0, restitution=0.0, **self._client
            )
        place, turn = pybullet.getDynamicsInfo(self._body, -1, **self._client)[3:5]
        self._com_m = np.array(place)
        self._principal = self._rotation(turn)
        self._principal_turn = turn
        self._servo = ServoTwin(description, options)

    def _load_robot(self) -> int:
        bullet, client = self._bullet, self._client
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "robot.urdf")
            path.write_text(urdf(self._description))
            body = int(
                bullet.loadURDF(
                    str(path),
                    useFixedBase=self._options.fixed_base,
                    flags=bullet.URDF_USE_INERTIA_FROM_FILE,
                    **client,
                )
            )
        links = range(len(self._description.joints))
        for link in (-1, *links):
            bullet.changeDynamics(
                body,
                link,
                linearDamping=0,
                angularDamping=0,
                jointDamping=0,
                lateralFriction=self._options.friction,
                spinningFriction=0,
                rollingFriction=0,
                restitution=0,
                **client,
            )
        # Bullet's joints come with velocity motors that hold them still.
        bullet.setJointMotorControlArray(
            body,
            list(links),
            bullet.VELOCITY_CONTROL,
            forces=[0] * len(links),
            **client,
        )
        if self._options.sinkage_m:
            spring = FootSpring.sinking(self._description, self._options.sinkage_m)
            soften_bullet(bullet, client, body, self._description, spring)
        for first, second in self._description.coupled:
            couple(bullet, client, body, first, second)
        return body

    def reset(self, pose_rad: FloatArray, height_m: float) -> BulletState:
        """Put the robot upright at the origin, its torso at a height, at rest."""
        # One step out of reach first: contacts of the last rollout would linger.
        self._place(pose_rad, height_m + _OUT_OF_REACH_M)
        self._bullet.stepSimulation(**self._client)
        self._place(pose_rad, height_m)
        self._servo.reset()
        self._read()
        return self._state(self._velocity)

    def _place(self, pose_rad: FloatArray, height_m: float) -> None:
        bullet, client = self._bullet, self._client
        if not self._options.fixed_base:
            bullet.resetBasePositionAndOrientation(
                self._body,
                (self._com_m + np.array([0, 0, height_m])).tolist(),
                self._principal_turn,
                **client,
            )
            bullet.resetBaseVelocity(self._body, [0] * 3, [0] * 3, **client)
        for link, angle in zip(self._links, pose_rad.tolist(), strict=True):
            bullet.resetJointState(self._body, link, angle, 0.0, **client)

    def step(self, schedule: Sequence[tuple[FloatArray, int]]) -> BulletState | None:
        """Advance by one tick.

        Args:
          schedule: command [rad] (joints,) and for how many physics steps it acts.

        Returns:
          The state after the tick, or None if the physics has blown up.
        """
        bullet, client = self._bullet, self._client
        before = self._velocity
        for command, steps in schedule:
            for _ in range(steps):
                torque = self._servo.torque(
                    self._pose, self._velocity, self._angles, self._speeds, command
                )
                if not np.isfinite(torque).all():
                    return None
                bullet.setJointMotorControlArray(
                    self._body,
                    self._links,
                    bullet.TORQUE_CONTROL,
                    forces=torque.tolist(),
                    **client,
                )
                bullet.stepSimulation(**client)
                before = self._velocity
                self._read()
        return self._state(before)

    def close(self) -> None:
        """Disconnect the client."""
        self._bullet.disconnect(**self._client)

    def _rotation(self, quaternion_xyzw: Any) -> FloatArray:
        flat = self._bullet.getMatrixFromQuaternion(quaternion_xyzw)
        return np.array(flat).reshape(3, 3)

    def _read(self) -> None:
        """Fetch joints and torso; Bullet's base is the torso's centre of mass."""
        bullet, client = self._bullet, self._client
        states = bullet.getJointStates(self._body, self._links, **client)
        self._angles = np.array([state[0] for state in states])
        self._speeds = np.array([state[1] for state in states])
        place, turn = bullet.getBasePositionAndOrientation(self._body, **client)
        linear, angular = bullet.getBaseVelocity(self._body, **client)
        turn = bullet.multiplyTransforms(
            [0] * 3, turn, [0] * 3, _conjugate(self._principal_turn)
        )[1]
        torso = self._rotation(turn)
        arm = torso @ self._com_m
        spin = np.array(angular)
        self._torso = torso
        self._pose = np.array([*(np.array(place) - arm), turn[3], *turn[:3]])
        self._velocity = np.concatenate(
            [np.array(linear) - _cross(spin, arm), torso.T @ spin]
        )

    def _state(self, before: FloatArray) -> BulletState:
        return BulletState(
            base_pose=self._pose,
            base_velocity=self._velocity,
            position_rad=self._angles,
            velocity_rad_s=self._speeds,
            gyroscope_rad_s=self._velocity[3:],
            accelerometer_m_s2=self._specific_force(before),
            foot_force_n=self._foot_forces(),
        )

    def _specific_force(self, before: FloatArray) -> FloatArray:
        """(3,) what the accelerometer feels, from the velocities one step apart."""
        change = (self._velocity - before) / self._options.timestep_s
        torso, spin = self._torso, self._velocity[3:]
        place = np.array(self._description.imu.accelerometer_m)
        linear = torso.T @ (change[:3] + np.array([0, 0, GRAVITY_M_S2]))
        turning = _cross(change[3:], place) + _cross(spin, _cross(spin, place))
        return np.asarray(linear + turning)

    def _foot_forces(self) -> FloatArray:
        forces = np.zeros((2, 4))
        for side, foot in enumerate(self._description.feet):
            contacts = self._bullet.getContactPoints(
                bodyA=self._body, linkIndexA=foot.joint, **self._client
            )
            if not contacts:
                continue
            link = self._bullet.getLinkState(
                self._body, foot.joint, computeForwardKinematics=1, **self._client
            )
            away_m = np.array([contact[5] for contact in contacts]) - link[4]
            points_m = away_m @ self._rotation(link[5])
            normal_n = np.array([contact[9] for contact in contacts])
            forces[side] = normal_n @ sensor_shares(foot.sensors_m, points_m[:, :2])
        return np.maximum(forces.ravel(), 0.0)


def _conjugate(quaternion_xyzw: Sequence[float]) -> list[float]:
    x, y, z, w = quaternion_xyzw
    return [-x, -y, -z, w]


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The cross product of two (3,) vectors; NumPy's own costs ten times as much."""
    ax, ay, az = a
    bx, by, bz = b
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
