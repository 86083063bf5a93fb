"""Recorded commands and torques, resampled to the physics steps of a replay."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from diagnosis.traces.trace import Trace, filled
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray, IntArray


class Held:
    """Values (T, j) that each hold from one row of a recording to the next.

    A physics step uses the mean over its duration. So a command may change within a
    step, and a delay need not be a whole number of steps.
    """

    def __init__(self, time_s: FloatArray, values: FloatArray) -> None:
        """Hold (T, j) values from (T,) times on; NaN becomes the value before it."""
        self._time_s, self._values = time_s, filled(values)
        steps = np.diff(time_s)[:, None] * self._values[:-1]
        start = np.zeros_like(self._values[:1])
        self._integral = np.vstack([start, np.cumsum(steps, axis=0)])

    def mean(self, start_s: FloatArray, step_s: float) -> FloatArray:
        """(..., j) mean values from (...) times `start_s` to `start_s + step_s`.

        The first value also holds before the first row, the last one for ever.
        """
        end_s = start_s + step_s
        return (self._integral_at(end_s) - self._integral_at(start_s)) / step_s

    def at(self, time_s: FloatArray) -> FloatArray:
        """(..., j) values that hold at (...) times."""
        return np.asarray(self._values[self._row(time_s)])

    def _integral_at(self, time_s: FloatArray) -> FloatArray:
        """(..., j) time integral of the values from the first row to (...) times."""
        row = self._row(time_s)
        since = (time_s - self._time_s[row])[..., None]
        return np.asarray(self._integral[row] + since * self._values[row])

    def _row(self, time_s: FloatArray) -> IntArray:
        """(...) indices of the rows whose values hold at (...) times."""
        row = np.searchsorted(self._time_s, time_s, side="right") - 1
        return np.clip(row, 0, len(self._time_s) - 1)


class Drive:
    """Commands and torques for n R simulations: n variants in R runs, variant first."""

    def __init__(self, runs: Sequence[Run], delay_s: FloatArray, step_s: float) -> None:
        """Collect the commands and torques of R runs, all with targets or all without.

        `delay_s` (n,) is the time until a command takes effect.
        """
        # variants with the same delay share their commands
        self._delays_s, self._which = np.unique(delay_s, return_inverse=True)
        self._step_s = step_s
        traces = [run.whole or run.trace for run in runs]
        targets = [None if trace.unheld else trace.command_rad for trace in traces]
        self._commands = list(map(_held, traces, targets))
        self._torques = list(map(_held, traces, map(_torque_nm, traces)))
        self._added = [_held(trace, trace.added_nm) for trace in traces]
        self._variants, self._joints = len(delay_s), traces[0].position_rad.shape[1]

    def at(self, now_s: FloatArray) -> tuple[FloatArray | None, FloatArray | None]:
        """(B, n R, j) mean targets [rad] and torques [N m] of B steps, or None each.

        `now_s` are (B, R) times at which the steps begin.
        """
        mean = partial(Held.mean, step_s=self._step_s)
        commands = self._all(self._commands, now_s, mean)
        return commands, self._all(self._torques, now_s, mean)

    def ends(self, now_s: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """(B, n R, j) targets [rad] as steps from (B, R) times begin and end."""
        before = self._all(self._commands, now_s, Held.at)
        after = self._all(self._commands, now_s + self._step_s, Held.at)
        return None if before is None or after is None else (before, after)

    def added(self, now_s: FloatArray) -> FloatArray | None:
        """(B, n R, j) recorded torques [N m] to be added to the servos', or None."""
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
        """(B, n R, j) values at (B, R) times, minus each variant's command delay."""
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
    """Values (T, j) of a recording, each held to the next row; None for None."""
    return None if values is None else Held(trace.time_s, values)


def _torque_nm(trace: Trace) -> FloatArray | None:
    """(T, j) torques [N m] on joints that no servo holds; None if servos hold them.

    They are the recording's torque targets, or without any the measured torques.
    """
    if not trace.unheld:
        return None
    targets = trace.command_torque_nm
    return trace.torque_nm if targets is None else targets
