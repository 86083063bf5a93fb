"""What traces tell servos to do, on the steps of a replay."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.traces.trace import Trace, filled
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Held:
    """Values that hold from one row of a trace to the next, as their integral.

    A step of a replay takes the mean over its time, so that a command which changes
    within a step does so at its own time, and a delay need not be whole steps.
    """

    time_s: FloatArray
    values: FloatArray
    integral: FloatArray

    @classmethod
    def of(cls, time_s: FloatArray, values: FloatArray) -> "Held":
        """Of (T,) times and (T, j) values; a missing value is the one before it."""
        values = filled(values)
        steps = np.diff(time_s)[:, None] * values[:-1]
        integral = np.vstack([np.zeros((1, values.shape[1])), np.cumsum(steps, axis=0)])
        return cls(time_s, values, integral)

    def mean(self, start_s: FloatArray, step_s: float) -> FloatArray:
        """(..., j) means over `start_s` (...) to `start_s + step_s`.

        Before the first row its value holds, after the last row the last one does.
        """
        end_s = start_s + step_s
        return (self._at(end_s) - self._at(start_s)) / step_s

    def at(self, time_s: FloatArray) -> FloatArray:
        """(..., j) values that hold from `time_s` (...) on."""
        return np.asarray(self.values[self._row(time_s)])

    def _at(self, time_s: FloatArray) -> FloatArray:
        row = self._row(time_s)
        since = (time_s - self.time_s[row])[..., None]
        return np.asarray(self.integral[row] + since * self.values[row])

    def _row(self, time_s: FloatArray) -> IntArray:
        row = np.searchsorted(self.time_s, time_s, side="right") - 1
        return np.clip(row, 0, len(self.time_s) - 1)


class Drive:
    """What drives the rows of a batch: n variants times R runs, variant by variant."""

    def __init__(self, runs: Sequence[Run], delay_s: FloatArray, step_s: float) -> None:
        """Find out which runs have position targets, and which torques.

        Args:
          runs: R, all driven the same way.
          delay_s: (n,) until what is commanded takes effect.
          step_s: of the replay.
        """
        # variants without a delay of their own share their commands
        self._delays_s, self._which = np.unique(delay_s, return_inverse=True)
        self._step_s = step_s
        traces = [run.whole or run.trace for run in runs]
        self._commands = [_held(trace, _command_rad(trace)) for trace in traces]
        self._torques = [_held(trace, _torque_nm(trace)) for trace in traces]
        self._added = [_held(trace, trace.added_nm) for trace in traces]
        self._variants, self._joints = len(delay_s), traces[0].position_rad.shape[1]

    def at(self, now_s: FloatArray) -> tuple[FloatArray | None, FloatArray | None]:
        """(B, n R, j) position targets and torques of (B, R) steps; None for none."""

        def mean(held: Held, late_s: FloatArray) -> FloatArray:
            return held.mean(late_s, self._step_s)

        return (
            self._all(self._commands, now_s, mean),
            self._all(self._torques, now_s, mean),
        )

    def ends(self, now_s: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """(B, n R, j) position targets as (B, R) steps begin and end; None for none."""
        before = self._all(self._commands, now_s, Held.at)
        after = self._all(self._commands, now_s + self._step_s, Held.at)
        return None if before is None or after is None else (before, after)

    def added(self, now_s: FloatArray) -> FloatArray | None:
        """(B, n R, j) torques beside the servos' own in (B, R) steps; None for none."""
        if not any(self._added):
            return None
        nothing = np.zeros((len(now_s), self._joints))
        columns = [
            nothing if one is None else one.mean(now_s[:, k], self._step_s)
            for k, one in enumerate(self._added)
        ]
        return np.tile(np.stack(columns, axis=1), (1, self._variants, 1))

    def _all(
        self,
        held: Sequence[Held | None],
        now_s: FloatArray,
        take: Callable[[Held, FloatArray], FloatArray],
    ) -> FloatArray | None:
        late_s = now_s[None] - self._delays_s[:, None, None]
        columns = [
            take(one, late_s[:, :, k]) for k, one in enumerate(held) if one is not None
        ]
        if len(columns) < len(held):
            return None
        # (delays, B, R, j), then (B, n, R, j)
        every = np.stack(columns, axis=2)[self._which].transpose(1, 0, 2, 3)
        return every.reshape(len(every), -1, every.shape[-1])


def _held(trace: Trace, values: FloatArray | None) -> Held | None:
    return None if values is None else Held.of(trace.time_s, values)


def _command_rad(trace: Trace) -> FloatArray | None:
    """What servos follow, where there are any."""
    return None if trace.unheld else trace.command_rad


def _torque_nm(trace: Trace) -> FloatArray | None:
    """What drives joints that no servo holds.

    The torque target if there is one, else what was measured.
    """
    if not trace.unheld:
        return None
    targets = trace.command_torque_nm
    return trace.torque_nm if targets is None else targets
