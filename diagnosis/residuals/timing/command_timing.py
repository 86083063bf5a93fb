"""Errors of the clock at commands: when exactly a command jumps is not known.

A command that jumps takes effect at another time than its row says, by the jitter of
the clock, and the whole motion that follows is as late. Its error lasts until the joint
has followed, unlike that of a reading (`clock.py`), so that it is marginalised jump by
jump. The many small changes of a smooth command average out.
"""

import itertools
from collections.abc import Sequence
from copy import copy

import numpy as np

from diagnosis.residuals.changes import Changes
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.timing.clock import ClockNoise
from diagnosis.residuals.tolerance import Tolerance, without_each
from diagnosis.traces.trace import Trace
from groundwalk.arrays import FloatArray, IntArray

JUMP = 3.0
"""Change of a command from row to row, as a multiple of its rms, from which on it is a
jump: a sum of sines has none, steps have little else."""


class CommandTiming:
    """Whitens residuals with the error of commands that jump early or late.

    Attributes:
      taken: number of the entries' squares that whitening takes out of noise.
    """

    def __init__(
        self,
        changes: FloatArray,
        jumps: IntArray,
        ends: Sequence[int],
        clock: ClockNoise | None = None,
    ) -> None:
        """Prepare the whitening, recording by recording.

        Args:
          changes: (rows, c) change of residuals by commands that are late by one
            standard deviation, in units of noise and 0 where errors do not count.
          jumps: (rows, c) number of the jump that each entry follows, see `jumps_of`.
          ends: rows after each recording.
          clock: residuals have been whitened for its errors before.
        """
        self._parts = [
            (last - first, _tolerance(changes, jumps, slice(first, last), clock))
            for first, last in itertools.pairwise([0, *ends])
        ]

    def part(self, recordings: slice) -> "CommandTiming":
        """That of some recordings."""
        some = copy(self)
        some._parts = self._parts[recordings]
        return some

    @property
    def taken(self) -> float:
        """Number of the entries' squares that whitening takes out of noise."""
        return sum(tolerance.taken for _, tolerance in self._parts)

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals, whitened."""
        return without_each(self._parts, residual)


def jumps_of(traces: Sequence[Trace], channels: Channels) -> IntArray:
    """(rows, c) number of the last jump of a channel's command, in compared rows.

    Joints whose commands jump in the same row share a number. 0 before the first jump
    of a recording, and for channels of no joint.
    """
    parts, count = [], 0
    for trace in traces:
        own = np.zeros((trace.ticks, len(channels.names)), int)
        if trace.command_rad is not None:
            jumps = _jumps(trace.command_rad)
            rows = np.flatnonzero(jumps.any(axis=1))
            number = np.zeros(trace.ticks, int)
            number[rows] = count + 1 + np.arange(len(rows))
            last = np.maximum.accumulate(np.where(jumps, number[:, None], 0), axis=0)
            joints = last.shape[1]
            for first in range(0, len(channels.names) - joints + 1, joints):
                if channels.names[first].startswith(("position.", "torque.")):
                    own[:, first : first + joints] = last
            count += len(rows)
        parts.append(own[trace.compared])
    return np.concatenate(parts)


def _jumps(command_rad: FloatArray) -> FloatArray:
    """(T, j) whether commands jump in a row."""
    change = np.nan_to_num(np.diff(command_rad, axis=0, prepend=command_rad[:1]))
    usual = np.sqrt(np.mean(change**2, axis=0))
    return np.asarray((np.abs(change) > JUMP * usual) & (usual > 0))


def _tolerance(
    changes: FloatArray, jumps: IntArray, rows: slice, clock: ClockNoise | None
) -> Tolerance:
    """What jumps in a recording change, each by one standard deviation."""
    own, follows = changes[rows], jumps[rows]
    numbers = np.unique(follows[follows > 0])
    each = np.where(follows == numbers[:, None, None], own, 0.0)
    if clock is not None and len(numbers):
        each = clock.part(rows).without(each)
    return Tolerance(Changes.of(each.reshape(len(numbers), own.size)))
