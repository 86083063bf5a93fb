"""A hidden world in PyBullet, at a fine step."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from groundwalk.arrays import FloatArray
from robots.sole import sensor_shares
from terrain import Heightfield
from worlds.hidden.body_sense import BodySense
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import HiddenPlant
from worlds.real.bullet_body import load_body
from worlds.real.ground import load_ground
from worlds.real.silence import import_bullet

if TYPE_CHECKING:
    import mujoco


class HiddenBullet:
    """One robot under joint torques; see `HiddenEngine`.

    The robot is made from the MuJoCo model, so that both engines carry the same bodies
    and the same gravity.
    """

    def __init__(
        self,
        plant: HiddenPlant,
        model: "mujoco.MjModel",
        effects: Sequence[Hidden],
        ground: Heightfield | None,
    ) -> None:
        """Connect a client of its own and load robot and ground."""
        bullet = import_bullet()
        self._bullet, self._plant = bullet, plant
        self._step_s = float(model.opt.timestep)
        self._gravity = model.opt.gravity.copy()
        self._client = {"physicsClientId": bullet.connect(bullet.DIRECT)}
        bullet.setGravity(*self._gravity.tolist(), **self._client)
        bullet.setTimeStep(self._step_s, **self._client)
        self._body = load_body(bullet, self._client, plant, model, effects)
        self._name_parts()
        if ground is not None:
            floor = load_ground(self._client["physicsClientId"], ground)
            bullet.changeDynamics(
                floor, -1, lateralFriction=1.0, restitution=0.0, **self._client
            )
        place, turn = bullet.getDynamicsInfo(self._body, -1, **self._client)[3:5]
        self._com_m, self._principal = np.array(place), turn
        self._watched, self._feet = 0, np.zeros(8)
        self._earlier: FloatArray | None = None

    def _name_parts(self) -> None:
        bullet, client = self._bullet, self._client
        count = bullet.getNumJoints(self._body, **client)
        rows = [bullet.getJointInfo(self._body, i, **client) for i in range(count)]
        number = {row[1].decode(): row[0] for row in rows}
        self._links = [number[name] for name in self._plant.joints]
        self._link_of = {row[12].decode(): row[0] for row in rows}
        base = bullet.getBodyInfo(self._body, **client)[0].decode()
        self._link_of[base] = -1
        self._control = bullet.TORQUE_CONTROL

    def reset(self, pose_rad: FloatArray, height_m: float) -> None:
        """Put the robot at rest; see `HiddenEngine`."""
        bullet, client = self._bullet, self._client
        if self._plant.floating:
            place = (self._com_m + np.array([0, 0, height_m])).tolist()
            bullet.resetBasePositionAndOrientation(
                self._body, place, self._principal, **client
            )
            bullet.resetBaseVelocity(self._body, [0] * 3, [0] * 3, **client)
        for link, angle in zip(self._links, pose_rad.tolist(), strict=True):
            bullet.resetJointState(self._body, link, angle, 0.0, **client)
        self._read()

    def step(self, torque_nm: FloatArray) -> None:
        """One fine step; see `HiddenEngine`."""
        self._bullet.setJointMotorControlArray(
            self._body,
            self._links,
            self._control,
            forces=torque_nm.tolist(),
            **self._client,
        )
        self._bullet.stepSimulation(**self._client)
        self._read()

    def _read(self) -> None:
        states = self._bullet.getJointStates(self._body, self._links, **self._client)
        self.position_rad = np.array([state[0] for state in states])
        self.velocity_rad_s = np.array([state[1] for state in states])

    def push(self, body: str, force_n: FloatArray) -> None:
        """Let a force act over the next step; see `HiddenEngine`."""
        link = self._link_of[body]
        bullet, client = self._bullet, self._client
        if link < 0:
            place = bullet.getBasePositionAndOrientation(self._body, **client)[0]
        else:
            place = self._link(link)[0]
        bullet.applyExternalForce(
            self._body, link, force_n.tolist(), place, bullet.WORLD_FRAME, **client
        )

    def _link(self, link: int) -> Any:
        return self._bullet.getLinkState(
            self._body,
            link,
            computeLinkVelocity=1,
            computeForwardKinematics=1,
            **self._client,
        )

    def body_velocity(self, body: str) -> FloatArray:
        """(3,) velocity of a body's centre of mass [m/s]; see `HiddenEngine`."""
        link = self._link_of[body]
        if link < 0:
            return np.array(self._bullet.getBaseVelocity(self._body, **self._client)[0])
        return np.array(self._link(link)[6])

    def watch(self) -> None:
        """Take the sensors in; see `HiddenEngine`."""
        if not self._plant.floating:
            return
        if self._earlier is None:
            self._earlier = self._base_motion()[2]
        self._watched += 1
        self._feet += self._foot_forces()

    def _base_motion(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, turn (3, 3), and (6,) velocities of the torso frame."""
        bullet, client = self._bullet, self._client
        place, turn = bullet.getBasePositionAndOrientation(self._body, **client)
        linear, angular = bullet.getBaseVelocity(self._body, **client)
        x, y, z, w = self._principal
        turn = bullet.multiplyTransforms([0] * 3, turn, [0] * 3, [-x, -y, -z, w])[1]
        self._turn = np.array([turn[3], *turn[:3]])
        torso = np.array(bullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        arm, spin = torso @ self._com_m, np.array(angular)
        origin = np.array(linear) - np.cross(spin, arm)
        return np.array(place) - arm, torso, np.concatenate([origin, torso.T @ spin])

    def sense(self) -> BodySense:
        """What the sensors say; see `HiddenEngine`."""
        description = self._plant.description
        if not self._plant.floating or description is None:
            zero = np.zeros(3)
            up = np.array([1.0, 0.0, 0.0, 0.0])
            felt = -self._gravity if description else zero
            return BodySense(zero, felt, np.zeros(8), zero, up, zero, zero)
        place, torso, motion = self._base_motion()
        earlier = motion if self._earlier is None else self._earlier
        steps = max(self._watched - 1, 1)
        change = (motion - earlier) / (steps * self._step_s)
        spin, lever = motion[3:], np.array(description.imu.accelerometer_m)
        turning = np.cross(change[3:], lever) + np.cross(spin, np.cross(spin, lever))
        felt = torso.T @ (change[:3] - self._gravity) + turning
        feet = np.maximum(self._feet / max(self._watched, 1), 0.0)
        self._watched, self._feet, self._earlier = 0, np.zeros(8), None
        return BodySense(spin, felt, feet, place, self._turn, motion[:3], spin)

    def _foot_forces(self) -> FloatArray:
        forces = np.zeros((2, 4))
        feet = self._plant.description.feet if self._plant.description else ()
        for side, foot in enumerate(feet):
            link = self._links[foot.joint]
            contacts = self._bullet.getContactPoints(
                bodyA=self._body, linkIndexA=link, **self._client
            )
            if contacts:
                state = self._link(link)
                flat = self._bullet.getMatrixFromQuaternion(state[5])
                away = np.array([contact[5] for contact in contacts]) - state[4]
                points = away @ np.array(flat).reshape(3, 3)
                normal = np.array([contact[9] for contact in contacts])
                forces[side] = normal @ sensor_shares(foot.sensors_m, points[:, :2])
        return forces.ravel()

    def close(self) -> None:
        """Disconnect the client."""
        self._bullet.disconnect(**self._client)
