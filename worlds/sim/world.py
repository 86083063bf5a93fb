"""The deterministic world "sim": MuJoCo computes many robots in one batch."""

from typing import TYPE_CHECKING

import numpy as np

from groundwalk.arrays import FloatArray
from groundwalk.errors import BadValueError
from worlds.observation import Observation, Truth
from worlds.rollouts import RolloutWorld, Schedule
from worlds.sim.model import (
    ROOT_QPOS,
    ROOT_QVEL,
    StartHeight,
    mujoco_model,
    touch_shares,
)
from worlds.world import TICK_S

if TYPE_CHECKING:
    from mujoco.batch import Batch


class SimWorld(RolloutWorld):
    """The world "sim": n robots in one `mujoco.batch.Batch`, each on its own ground.

    Robot i's rollout has the same bits whatever n is and however many threads run.

    Attributes:
      qvel: (n, v) velocities of all v degrees of freedom [rad/s; m/s]; a live view of
        MuJoCo's data.
    """

    def _open(self) -> None:
        """Compile a model for each distinct ground, and make the batch of n robots."""
        if self.options.hidden:
            raise BadValueError("a sim has no hidden physics; only the real world can")
        self._batch = self._made_batch()
        self._qpos = self._batch.bind("qpos")
        self.qvel = self._batch.bind("qvel")
        self._ctrl = self._batch.bind("ctrl")
        self._sensors = self._batch.bind("sensordata")
        self._shares = touch_shares(self.description)
        fixed = self.options.fixed_base
        self._joints = slice(0 if fixed else ROOT_QPOS, None)
        self._speeds = slice(0 if fixed else ROOT_QVEL, None)
        self._start_height = StartHeight(self.description)

    def close(self) -> None:
        """Do nothing: a batch has no process to end, and Python frees its memory."""

    def _made_batch(self) -> "Batch":
        """Make a batch with a simulation for each robot on its own ground."""
        from mujoco.batch import Batch

        robot, options, models = self.description, self.options, {}
        for ground in self._grounds:
            if id(ground) not in models:
                under = None if options.fixed_base else ground
                models[id(ground)] = mujoco_model(robot, options, under)
        per_robot = [models[id(ground)] for ground in self._grounds]
        batch = Batch(per_robot[0], self.n, self.options.threads)
        if len(models) > 1:
            batch.set_models(per_robot)
        return batch

    def _start(self, pose_rad: FloatArray) -> None:
        self._batch.reset()
        self._qpos[:, self._joints] = pose_rad
        self._start_height_m = self._start_height.heights_m(pose_rad, self._grounds)
        if not self.options.fixed_base:
            self._qpos[:, 2] = self._start_height_m
        self._ctrl[:] = pose_rad
        self._batch.forward()

    def _advance(self, schedule: Schedule) -> None:
        for targets, steps in schedule:
            self._ctrl[:] = targets
            self._run(steps)

    def _run(self, steps: int) -> None:
        """Advance the active robots by physics steps; NaN marks those that diverge."""
        from mujoco.batch import SimulationError

        try:
            self._batch.step(ids=self.active, nstep=steps)
        except SimulationError as error:
            self._qpos[error.ids] = np.nan

    def _read(self) -> tuple[Truth, Observation]:
        """Current positions and velocities; forces, acceleration of the last step."""
        touch = len(self._shares)
        truth = self._read_truth()
        observation = Observation(
            time_s=self._ticks * TICK_S,
            position_rad=self._qpos[:, self._joints].copy(),
            velocity_rad_s=self.qvel[:, self._speeds].copy(),
            gyroscope_rad_s=truth.base_angular_velocity_rad_s.copy(),
            accelerometer_m_s2=self._sensors[:, touch + 3 : touch + 6].copy(),
            foot_force_n=np.maximum(self._foot_forces(), 0.0),
        )
        return truth, observation

    def _read_truth(self) -> Truth:
        if self.options.fixed_base:
            zeros = np.zeros((self.n, 3))
            position = zeros.copy()
            position[:, 2] = self._start_height_m
            upright = np.tile([1.0, 0.0, 0.0, 0.0], (self.n, 1))
            return Truth(position, upright, zeros, zeros)
        return Truth(
            base_position_m=self._qpos[:, :3].copy(),
            base_orientation=self._qpos[:, 3:7].copy(),
            base_linear_velocity_m_s=self.qvel[:, :3].copy(),
            base_angular_velocity_rad_s=self.qvel[:, 3:6].copy(),
        )

    def _foot_forces(self) -> FloatArray:
        """(n, 8) foot sensor forces [N]; a loop gives the same bits for every n."""
        touch = self._sensors[:, : len(self._shares)]
        forces = np.zeros((self.n, self._shares.shape[1]))
        for k, shares in enumerate(self._shares):
            forces += touch[:, k, None] * shares
        return forces
