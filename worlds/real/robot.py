"""One robot of the world "real": a body in PyBullet with the motors of the sim."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description
from robots.engine_models.urdf import urdf
from terrain import Heightfield
from worlds.hidden.engine import HiddenEngine
from worlds.real.body import BulletBody
from worlds.real.servo_twin import ServoTwin
from worlds.soft_ground import FootSpring
from worlds.world import WorldOptions

_OUT_OF_REACH_M = 100.0
"""Height above the start height [m] at which nothing can touch the ground."""


class BulletState(NamedTuple):
    """State of one robot in PyBullet, and its noiseless sensors, after a tick.

    Attributes:
      base_pose: (7,) torso position [m] and quaternion w, x, y, z.
      base_velocity: (6,) linear [m/s] in the world, angular [rad/s] in the torso frame.
      gyroscope_rad_s: (3,) torso frame.
      accelerometer_m_s2: (3,) torso frame, mean over the last physics step.
      foot_force_n: (8,) foot sensor forces in the last physics step, left foot first.
      position_rad, velocity_rad_s: (joints,) state of the joints.
    """

    base_pose: FloatArray
    base_velocity: FloatArray
    gyroscope_rad_s: FloatArray
    accelerometer_m_s2: FloatArray
    foot_force_n: FloatArray
    position_rad: FloatArray
    velocity_rad_s: FloatArray


def restart(
    body: BulletBody | HiddenEngine, pose_rad: FloatArray, height_m: float
) -> None:
    """Put a robot at rest in a pose (joints,), its torso upright at a height.

    It takes a step out of reach first: contacts of the last rollout would linger.
    """
    body.reset(pose_rad, height_m + _OUT_OF_REACH_M)
    body.step(np.zeros(len(pose_rad)))
    body.reset(pose_rad, height_m)


class BulletRobot:
    """A robot on its ground in PyBullet, with the motors of the sim (`ServoTwin`).

    Attributes:
      body: the robot in its PyBullet client.
    """

    def __init__(
        self, description: Description, ground: Heightfield, options: WorldOptions
    ) -> None:
        """Connect a PyBullet client of its own, and load robot and ground into it."""
        spring = None
        if options.sinkage_m:
            spring = FootSpring.sinking(description, options.sinkage_m)
        self.body = BulletBody(
            urdf(description),
            description.joints,
            description,
            floating=not options.fixed_base,
            step_s=options.timestep_s,
            gravity_m_s2=np.array([0.0, 0.0, -GRAVITY_M_S2]),
            friction=options.friction,
            spring=spring,
            ground=None if options.fixed_base else ground,
        )
        self._step_s = options.timestep_s
        self._servo = ServoTwin(description, options)

    def reset(self, pose_rad: FloatArray, height_m: float) -> BulletState:
        """Put the robot at rest in a pose (joints,), its torso upright at a height."""
        restart(self.body, pose_rad, height_m)
        self._servo.reset()
        pose, velocity = self.body.base_motion()
        return self._state(pose, velocity, velocity)

    def step(self, schedule: Sequence[tuple[FloatArray, int]]) -> BulletState | None:
        """Advance by one tick; the state is None if the physics diverged.

        The schedule holds commands (joints,) [rad], each with its number of steps.
        """
        body = self.body
        pose, velocity = body.base_motion()
        before = velocity
        for command, steps in schedule:
            for _ in range(steps):
                torque = self._servo.torque(
                    pose, velocity, body.position_rad, body.velocity_rad_s, command
                )
                if not np.isfinite(torque).all():
                    return None
                body.step(torque)
                before = velocity
                pose, velocity = body.base_motion()
        return self._state(pose, velocity, before)

    def close(self) -> None:
        """Disconnect the PyBullet client; the robot cannot be used afterwards."""
        self.body.close()

    def _state(
        self, pose: FloatArray, velocity: FloatArray, before: FloatArray
    ) -> BulletState:
        """The state, from the torso's pose and its velocities now and a step before."""
        body = self.body
        return BulletState(
            base_pose=pose,
            base_velocity=velocity,
            gyroscope_rad_s=velocity[3:],
            accelerometer_m_s2=body.specific_force(
                pose, before, velocity, self._step_s
            ),
            foot_force_n=np.maximum(body.foot_forces(), 0.0),
            position_rad=body.position_rad,
            velocity_rad_s=body.velocity_rad_s,
        )
