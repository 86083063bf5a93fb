"""Takes many steps of replays at once, where servos do nothing but follow commands.

Between two steps most replays have nothing to do: commands are known in advance, and
MuJoCo's actuators are the servos. Then MuJoCo takes all steps of a block by itself,
which saves most of the time where few robots are simulated. Where a servo saturates,
its law is needed at every step: such a block is begun again, and taken step by step.
"""

from dataclasses import dataclass

import numpy as np
from mujoco import mjtState
from mujoco.batch import Batch, SimulationError

from diagnosis.plant.plant import Plant
from diagnosis.replay.laws import BatchLaws
from diagnosis.replay.servos import columns
from groundwalk.arrays import FloatArray

PAUSE = 256
"""Steps that are taken one by one after a block that had to be begun again; twice as
many after the next such block, and so on, so that little time is lost."""


@dataclass(frozen=True, eq=False)
class Rolled:
    """States after each of k steps of n simulations.

    Attributes:
      qpos, qvel: (n, k, nq) and (n, k, nv), MuJoCo's.
      actuator_force: (n, k, nu) forces during the steps, MuJoCo's.
    """

    qpos: FloatArray
    qvel: FloatArray
    actuator_force: FloatArray


class Rolling:
    """Takes steps of a replay inside MuJoCo, as long as no law is needed at them."""

    def __init__(self, batch: Batch, laws: BatchLaws, plant: Plant) -> None:
        """Prepare for a batch of robots with their laws, in their start states."""
        self._batch, self._laws = batch, laws
        self._actuators = columns(plant.actuators)
        self._angles, self._dofs = columns(plant.qpos), columns(plant.dofs)
        self._ctrl = np.asarray(batch.bind("ctrl"))
        self._applied = np.asarray(batch.bind("qfrc_applied"))
        self._wait, self._pause = 0, PAUSE

    def waits(self) -> bool:
        """Whether the next step is to be taken by itself; counts it if so."""
        if self._wait:
            self._wait -= 1
            return True
        return not self._laws.only_follow

    def taken(
        self,
        steps: int,
        asked_rad: FloatArray | None,
        pushed_nm: FloatArray | None,
    ) -> Rolled | None:
        """Take k `steps`; None, in the state before them, if a law is needed at one.

        `asked_rad` (k, n, j) are position targets in measured angles that do not jump
        within a step, `pushed_nm` (k, n, j) torques on the joints; None for none.
        """
        batch, laws = self._batch, self._laws
        before, inertia = batch.state.copy(), laws.inertia_kg_m2().copy()
        warned = batch.warning.sum()
        angle, speed = (one.copy() for one in laws.joint_state())
        target = None if asked_rad is None else asked_rad - laws.joints["offset_rad"]
        rolled: Rolled | None
        try:
            found = batch.rollout(
                steps,
                *self._control(steps, target, pushed_nm),
                record=("qpos", "qvel", "actuator_force"),
            )
            rolled = Rolled(*found.values())
        except SimulationError:
            rolled = None
        if (
            rolled is None
            or batch.warning.sum() > warned
            or (target is not None and self._saturate(target, angle, speed, rolled))
        ):
            batch.state[:] = before
            laws.begin_again(inertia)
            self._wait, self._pause = self._pause, 2 * self._pause
            return None
        return rolled

    def _control(
        self, steps: int, target: FloatArray | None, pushed_nm: FloatArray | None
    ) -> tuple[FloatArray | None, int]:
        """(n, k, controls) inputs of k steps, and MuJoCo's number of their kind."""
        inputs, kind = [], 0
        for values, field, own, bit in (
            (target, self._ctrl, self._actuators, mjtState.mjSTATE_CTRL),
            (pushed_nm, self._applied, self._dofs, mjtState.mjSTATE_QFRC_APPLIED),
        ):
            if values is not None:
                every = np.repeat(field[:, None], steps, axis=1)
                every[:, :, own] = values.transpose(1, 0, 2)
                inputs.append(every)
                kind |= int(bit.value)
        return np.concatenate(inputs, axis=2) if inputs else None, kind

    def _saturate(
        self, target: FloatArray, angle: FloatArray, speed: FloatArray, rolled: Rolled
    ) -> bool:
        """Whether a servo's torque exceeds its limit as any of the steps begins."""
        angles = rolled.qpos[:, :-1, self._angles]
        speeds = rolled.qvel[:, :-1, self._dofs]
        angles = np.concatenate([angle[:, None], angles], axis=1)
        speeds = np.concatenate([speed[:, None], speeds], axis=1)
        return self._laws.saturate(target.transpose(1, 0, 2), angles, speeds)
