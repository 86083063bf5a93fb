"""The servo law of the sim's motors, for an engine that only takes joint torques.

Both worlds must run one servo law, or "nothing is missing" has no meaning. Bullet's
own position motors are no PD servos, and a PD torque computed at the start of a step
explodes on light links. The torque here is implicit in velocity, as a stable PD
(Tan, Liu, Turk 2011, "Stable Proportional-Derivative Controllers"): a MuJoCo model of
the same robot without contacts takes the same step, and what its motors gave over
that step, force at the start plus damping times the change of velocity, is the torque.
So there is one implementation of the motor, MuJoCo's.

A twin without contacts would compute that a standing leg flies up, and damp that
motion. Therefore it gets the generalised contact force of the step before, which
follows from the difference of the robot's and the twin's velocities:
f = M (v - v_twin) / dt.
"""

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from worlds.sim.model import ROOT_QPOS, ROOT_QVEL, mujoco_model
from worlds.world import WorldOptions


class ServoTwin:
    """The motors of one robot in an engine that only takes joint torques."""

    def __init__(self, description: Description, options: WorldOptions) -> None:
        """Make the model without ground.

        Args:
          description: the robot.
          options: time step and whether the base is fixed.
        """
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
        # -dtau/dv of the motor as long as its drive is not saturated, and beyond
        self._damping = np.array([motor.kd_nm_s_rad for motor in motors])
        self._back_emf = np.array([motor.back_emf_nm_s_rad for motor in motors])
        self._twin_velocity: FloatArray | None = None

    def reset(self) -> None:
        """Forget the last rollout and its contact force: the next step is the first."""
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
        """Joint torques [N m] to hold over the next physics step.

        Args:
          base_pose: (7,) position [m] and quaternion w, x, y, z; unused if fixed.
          base_velocity: (6,) linear [m/s] in the world, angular [rad/s] in the torso
            frame; unused if fixed.
          position_rad: (joints,) where the joints are.
          velocity_rad_s: (joints,) how fast they move.
          command_rad: (joints,) position targets.
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
