"""A batch of simulations, one per variant and run."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from diagnosis.effects.variants import Variants
from diagnosis.plant.servo import Servo
from diagnosis.replay.conforming_ground import conform
from diagnosis.replay.laws import BatchLaws
from diagnosis.traces.trace import Trace
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray


class ReplayBatch:
    """n variants times R runs, variant by variant.

    Attributes:
      laws: what drives the simulations; not MuJoCo's own.
    """

    def __init__(
        self,
        runs: Sequence[Run],
        variants: Variants,
        step_s: float,
        threads: int,
    ) -> None:
        """Put every simulation into the state that its run starts from."""
        from mujoco.batch import Batch

        plant = variants.plant
        self.plant, self.step_s = plant, step_s
        self.n, self.count = variants.n * len(runs), len(runs)
        self._batch = Batch(plant.model, self.n, threads)
        np.asarray(self._batch.expand("opt.timestep"))[:] = step_s
        self.qpos, self.qvel = map(self.bind, ("qpos", "qvel"))
        servos = [_servo(run.trace) for run in runs]
        self.laws = BatchLaws(self._batch, variants, servos, step_s)
        self._start(runs, variants)
        self.laws.begin()

    def step(self) -> None:
        """One step of physics; what blows up becomes NaN."""
        from mujoco.batch import SimulationError

        try:
            self._batch.step()
        except SimulationError as error:
            self.qpos[error.ids] = np.nan

    def bind(self, name: str) -> FloatArray:
        """A live view of a field of the simulations."""
        return np.asarray(self._batch.bind(name))

    def _start(self, runs: Sequence[Run], variants: Variants) -> None:
        n, plant = self.n // self.count, self.plant
        measured = np.tile([run.position_rad for run in runs], (n, 1))
        velocity = np.tile([run.velocity_rad_s for run in runs], (n, 1))
        # what is measured now, the joints have left behind
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
            each = [run for _ in range(n) for run in runs]
            conform(self._batch, plant, each, np.repeat(height_m, self.count))


def _servo(trace: Trace) -> Servo:
    """A trace's servo; where torques drive it only the motor's back-EMF is left."""
    if trace.command_rad is not None:
        return trace.servo
    none = np.zeros_like(trace.servo.kp_nm_rad)
    return replace(trace.servo, kp_nm_rad=none, kd_nm_s_rad=none)
