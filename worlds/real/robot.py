"""One robot of the world "real": a body in PyBullet with the motors of the sim.

The sim and the real world must have the same motors, or a comparison would find a
difference where no physics is missing. PyBullet's own position motors are no PD servos,
and a PD torque computed at the start of a step is unstable on light links. The torque
here is implicit in velocity (Tan, Liu, Turk 2011, "Stable Proportional-Derivative
Controllers"): a twin, a MuJoCo model of the same robot without contacts, takes the same
step, and the torque of its motors over that step is applied in PyBullet: the torque at
the start minus damping times the change of velocity.

Without contacts the legs of a standing twin would fly up, and its motors would damp
that motion. Therefore the twin feels the generalised contact force of the step before,
which follows from the velocities of robot and twin: f = M (v - v_twin) / dt.
"""

from collections.abc import Sequence

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.gravity import GRAVITY_M_S2
from robots.description import Description
from robots.engine_models.urdf import urdf
from terrain import Heightfield
from worlds.hidden.engine import BodySense, HiddenEngine
from worlds.real.body import BulletBody
from worlds.sim.world import ROOT_QPOS, ROOT_QVEL, mujoco_model
from worlds.soft_ground import FootSpring
from worlds.world import WorldOptions


class ServoTwin:
    """Computes the joint torques of one robot's motors with a MuJoCo twin of the robot.

    The twin has no contacts and takes each physics step before PyBullet does.
    """

    def __init__(self, description: Description, options: WorldOptions) -> None:
        """Compile the MuJoCo twin, with the options' time step and fixed base."""
        import mujoco

        self._mujoco = mujoco
        self._model = mujoco_model(description, options, ground=None)
        self._data = mujoco.MjData(self._model)
        root = 0 if options.fixed_base else 1
        self._q = slice(root * ROOT_QPOS, None)
        self._v = slice(root * ROOT_QVEL, None)
        self._has_root = not options.fixed_base
        motors = [link.motor for link in description.links]
        self._stall = np.array([motor.stall_torque_nm for motor in motors])
        self._stiffness = np.array([motor.kp_nm_rad for motor in motors])
        # -d(torque)/d(velocity) of a motor, without and with a saturated drive
        self._damping = np.array([motor.kd_nm_s_rad for motor in motors])
        self._back_emf = np.array([motor.back_emf_nm_s_rad for motor in motors])
        self._twin_velocity: FloatArray | None = None

    def reset(self) -> None:
        """Forget the last rollout: the next step starts without a contact force."""
        self._mujoco.mj_resetData(self._model, self._data)
        self._twin_velocity = None

    def torque(
        self,
        base_pose: FloatArray,
        base_velocity: FloatArray,
        position_rad: FloatArray,
        velocity_rad_s: FloatArray,
        command_rad: FloatArray,
    ) -> FloatArray:
        """(joints,) torques [N m] to apply over the next physics step.

        From the joints' state and targets (joints,), and the base's position [m] and
        quaternion w, x, y, z (7,) and linear [m/s, world frame] and angular velocity
        [rad/s, torso frame] (6,), which are unused if the base is fixed.
        """
        data, model = self._data, self._model
        velocity = velocity_rad_s
        if self._has_root:
            velocity = np.concatenate([base_velocity, velocity_rad_s])
        contact = np.zeros(model.nv)
        if self._twin_velocity is not None:
            change = velocity - self._twin_velocity
            self._mujoco.mj_mulM(model, data, contact, change)
            contact /= model.opt.timestep
            contact += data.qfrc_applied
        if self._has_root:
            data.qpos[:ROOT_QPOS] = base_pose
        data.qpos[self._q] = position_rad
        data.qvel[:] = velocity
        data.ctrl[:] = command_rad
        data.qfrc_applied[:] = contact
        self._mujoco.mj_step(model, data)
        self._twin_velocity = data.qvel.copy()
        drive = self._stiffness * (command_rad - position_rad)
        drive -= (self._damping - self._back_emf) * velocity_rad_s
        damping = np.where(np.abs(drive) < self._stall, self._damping, self._back_emf)
        change_rad_s = data.qvel[self._v] - velocity_rad_s
        return np.asarray(data.actuator_force - damping * change_rad_s)


_OUT_OF_REACH_M = 100.0
"""Height above the start height [m] at which nothing can touch the ground."""


BulletState = tuple[FloatArray, ...]
"""Fields of `BodySense` after a tick, then position [rad] and velocity [rad/s] of the
joints, each (joints,)."""


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
    """A robot on its ground in PyBullet, with the motors of the sim (`ServoTwin`)."""

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
        felt = body.specific_force(pose, before, velocity, self._step_s)
        sense = BodySense.of_base(pose, velocity, felt, body.foot_forces())
        return (*sense, body.position_rad, body.velocity_rad_s)
