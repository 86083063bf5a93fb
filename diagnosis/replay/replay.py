"""Replays: variants of a robot model driven by the commands of recordings."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from mujoco.batch import Batch, SimulationError

from diagnosis.effects.variants import Variants
from diagnosis.plant.servo import Servo
from diagnosis.replay.conforming_ground import conform
from diagnosis.replay.drive import Drive
from diagnosis.replay.laws import BatchLaws
from diagnosis.replay.tape import Replayed, Tape
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

STEP_S = 0.002
"""Default time step of the physics in replays.

Example:
  >>> predicted = replay(runs, variants, step_s=STEP_S / 2)
"""

BLOCK = 256
"""Number of physics steps whose commands are computed at once, for speed; any value of
this order does."""


def replay(
    runs: Sequence[Run], variants: Variants, step_s: float = STEP_S, threads: int = 1
) -> list[Replayed]:
    """Simulate every variant of a robot model under the commands of every recording.

    Args:
      runs: R recordings or parts of them, each with its own start state.
      variants: n variants of the robot model.
      step_s: time step of the physics.
      threads: number of threads of the batch of simulations.

    Returns:
      For each run the predicted measurements of all variants.

    Example:
      >>> predicted = replay(runs, variants, threads=4)
      >>> position_rad = predicted[0].position_rad  # (n, rows, joints) of the first run
    """
    batch = ReplayBatch(runs, variants, step_s, threads)
    start_s = np.array([run.trace.time_s[0] for run in runs])
    longest_s = max(run.trace.duration_s for run in runs)
    steps = int(np.ceil((longest_s + 1e-9) / step_s))
    drive = Drive(runs, variants.signals.command_delay_s, step_s)
    tape = Tape(batch, steps)
    for first in range(0, steps, BLOCK):
        numbers = np.arange(first, min(first + BLOCK, steps))
        now_s = start_s + numbers[:, None] * step_s
        asked, pushed = drive.at(now_s)
        jumps = batch.laws.jumps(drive.ends(now_s))
        added = drive.added(now_s)
        for i in range(len(numbers)):
            if asked is not None:
                batch.laws.servo(asked[i], now_s[i], jumps[i])
            if pushed is not None:
                batch.laws.push_joints(pushed[i], now_s[i])
            if added is not None:
                batch.laws.add_to_joints(added[i])
            batch.laws.push_bodies(now_s[i])
            batch.step()
            tape.note(first + i + 1)
    return tape.read(runs, variants)


class ReplayBatch:
    """Simulations of all variants of a robot model in all runs, sorted by variant.

    Attributes:
      laws: applies servos, friction and forces.
      n: number of simulations, variants times runs.
      count: number of runs.
      qpos: (n, nq) MuJoCo's positions, which change as the simulations step.
      qvel: (n, nv) MuJoCo's velocities, which change as the simulations step.
    """

    def __init__(
        self, runs: Sequence[Run], variants: Variants, step_s: float, threads: int
    ) -> None:
        """Put every simulation into its run's start state; arguments of `replay`."""
        self.plant, self.step_s = variants.plant, step_s
        self.n, self.count = variants.n * len(runs), len(runs)
        self._batch = Batch(self.plant.model, self.n, threads)
        np.asarray(self._batch.expand("opt.timestep"))[:] = step_s
        self.qpos, self.qvel = map(self.bind, ("qpos", "qvel"))
        servos = [_servo(run.trace) for run in runs]
        self.laws = BatchLaws(self._batch, variants, servos, step_s)
        self._start(runs, variants)
        self.laws.begin()

    def step(self) -> None:
        """Take one step of physics; a simulation that diverges gets NaN positions."""
        try:
            self._batch.step()
        except SimulationError as error:
            self.qpos[error.ids] = np.nan

    def bind(self, name: str) -> FloatArray:
        """View of a field of `MjData` of all simulations; it changes as they step."""
        return np.asarray(self._batch.bind(name))

    def _start(self, runs: Sequence[Run], variants: Variants) -> None:
        """Set start positions and velocities, and ground bumps under the soles."""
        n, plant = variants.n, self.plant
        measured = np.tile([run.position_rad for run in runs], (n, 1))
        velocity = np.tile([run.velocity_rad_s for run in runs], (n, 1))
        # late sensors show where the joints were; by now they have moved on
        late_s = np.repeat(variants.signals.sensor_delay_s, self.count)[:, None]
        start = measured + late_s * velocity - self.laws.joints["offset_rad"]
        self.qpos[:, plant.qpos], self.qvel[:, plant.dofs] = start, velocity
        bases = [run.base for run in runs if run.base is not None]
        if bases:
            base = np.tile(bases, (n, 1))
            self.qpos[:, :7], self.qvel[:, :6] = base[:, :7], base[:, 7:]
        self._batch.forward()
        height_m = variants.outside.bump_height_m
        if height_m.any() and bases:
            conform(self._batch, plant, [*runs] * n, np.repeat(height_m, self.count))


def _servo(trace: Trace) -> Servo:
    """A recording's servo; only its back-EMF if torque commands drive the joints."""
    if trace.command_rad is not None:
        return trace.servo
    none = np.zeros_like(trace.servo.kp_nm_rad)
    return replace(trace.servo, kp_nm_rad=none, kd_nm_s_rad=none)
