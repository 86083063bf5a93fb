"""Computes the torque of the sim's MuJoCo motors for a robot that PyBullet steps.

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

import numpy as np

from groundwalk.arrays import FloatArray
from robots.description import Description
from worlds.sim.model import ROOT_QPOS, ROOT_QVEL, mujoco_model
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

        Args:
          base_pose: (7,) position [m], quaternion w, x, y, z; unused if base is fixed.
          base_velocity: (6,) linear [m/s] in the world frame, angular [rad/s] in the
            torso frame; unused if the base is fixed.
          position_rad: (joints,) joint positions.
          velocity_rad_s: (joints,) joint velocities.
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
