"""Times at which joints rest on an end stop, where compared torques tell little.

A stop bears any torque that presses a joint against it. So in torque that the motion
does not need there is no evidence but its sign: the load of the stop may be anything
from zero to what the motor can do, each as likely (its likelihood is marginalised).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.scales import inertia_kg_m2
from diagnosis.effects.variants import Variants
from diagnosis.plant.plant import Plant
from diagnosis.traces.noise import noise_of
from diagnosis.traces.trace import Trace
from groundwalk.arrays import BoolArray, FloatArray

CLOSE = 3.0
"""Distance from a stop, in standard deviations of sensor noise, at which a joint rests
on it."""

GIVE_S = 0.005
"""Time constant [s] with which a stop pushes a joint back, as that of the effect. A
stop gives way by its square times the acceleration that a torque would make.
"""

LEAST_RAD = 1e-5
"""Least noise of a position: contacts give way by more."""

LEAST_LOAD = 4.0
"""Least range of a stop's load [noise]: one of less could not be seen."""


@dataclass(frozen=True, eq=False)
class StopContact:
    """How far joints went in each block of time, and what a stop may bear.

    Attributes:
      highest_rad, lowest_rad: (blocks, j) in a block and those next to it, from which
        the block's motion is smoothed.
      noise_rad: (j,) rms of the noise of the positions.
      give_rad: (j,) how far a stop may give way.
      cost: (j,) twice the nats that a block on a stop costs: the logarithm of the range
        of its load, in units of noise.
    """

    plant: Plant
    highest_rad: FloatArray
    lowest_rad: FloatArray
    noise_rad: FloatArray
    give_rad: FloatArray
    cost: FloatArray

    @classmethod
    def of(
        cls,
        plant: Plant,
        traces: Sequence[Trace],
        block_rows: Sequence[int],
        largest_nm: FloatArray,
        noise_nm: FloatArray,
    ) -> "StopContact":
        """See how far joints went in blocks of so many rows of each trace.

        `largest_nm` (j,) is the largest torque that was measured at each joint,
        `noise_nm` (j,) the noise of a block.
        """
        high, low = list[FloatArray](), list[FloatArray]()
        noise_rad = np.max([_noise_rad(one) for one in traces], axis=0)
        for trace, rows in zip(traces, block_rows, strict=True):
            for start in range(0, trace.ticks, rows):
                near = slice(max(start - rows, 0), start + 2 * rows)
                q = trace.position_rad[near]
                high.append(np.max(np.where(np.isnan(q), -np.inf, q), axis=0))
                low.append(np.min(np.where(np.isnan(q), np.inf, q), axis=0))
        load = np.maximum(largest_nm / noise_nm, LEAST_LOAD)
        cost = 2 * np.log(load / np.sqrt(2 * np.pi))
        inertia = np.array([inertia_kg_m2(plant, joint) for joint in plant.joints])
        give_rad = GIVE_S**2 * largest_nm / inertia
        return cls(plant, np.array(high), np.array(low), noise_rad, give_rad, cost)

    def rested(self, wrong: FloatArray, variants: Variants) -> FloatArray:
        """(n, blocks, j) torques left [noise], where joints rest on stops as costs.

        `wrong` (n, blocks, j) are measured less needed torques for n variants of the
        robot, 0 where they do not count. A stop that is not the nominal model's also
        costs how far a joint went beyond it, in noise.
        """
        nominal = self._ranges(None, None)
        fields = variants.fields
        limits, flags = fields.get("jnt_range"), fields.get("jnt_limited")
        found = wrong.copy()
        for row in range(len(wrong)):
            ranges = self._ranges(
                None if limits is None else limits[row],
                None if flags is None else flags[row],
            )
            for end, side in enumerate((-1.0, 1.0)):
                stop = ranges[:, end]
                own = stop != nominal[:, end]
                found[row] = self._at(stop, side, own, wrong[row], found[row])
        return found

    def _at(
        self,
        stop_rad: FloatArray,
        side: float,
        own: BoolArray,
        wrong: FloatArray,
        found: FloatArray,
    ) -> FloatArray:
        """(blocks, j) torques left with stops at (j,) angles on one side of joints."""
        far_rad = self.highest_rad if side > 0 else self.lowest_rad
        depth = side * (far_rad - stop_rad) / self.noise_rad
        here = (depth >= -CLOSE) & (wrong != 0)
        against = np.minimum(side * wrong, 0.0)
        most = CLOSE + self.give_rad / self.noise_rad
        beyond = np.where(own & here, np.maximum(depth - most, 0.0), 0.0)
        borne = side * np.sqrt(self.cost + against**2 + beyond**2)
        return np.where(here, borne, found)

    def _ranges(
        self, limits: FloatArray | None, flags: FloatArray | None
    ) -> FloatArray:
        """(j, 2) ends of the joints' ranges; infinite without one.

        `limits` and `flags` are those of all joints of a model; None for the nominal.
        """
        model = self.plant.model
        hinges = [int(model.joint(name).id) for name in self.plant.joints]
        ranges = (model.jnt_range if limits is None else limits)[hinges]
        limited = (model.jnt_limited if flags is None else flags)[hinges] > 0
        return np.where(limited[:, None], ranges, (-np.inf, np.inf))


def _noise_rad(trace: Trace) -> FloatArray:
    """(j,) rms of the noise of a recording's positions."""
    every = [noise_of(trace.time_s, q).total for q in trace.position_rad.T]
    return np.maximum(every, LEAST_RAD)
