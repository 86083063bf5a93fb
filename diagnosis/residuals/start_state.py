"""Removes from residuals the influence of uncertain start states of the simulation.

A simulation starts from measured positions, known up to sensor noise, and velocities,
known less well. The error of a wrong start fades within moments on well damped servos
and lasts for seconds on others. Its course (signature) is measured once for each joint,
and residuals are whitened with it: start states are marginalised, not fitted.
"""

import itertools
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from diagnosis.residuals.changes import Changes
from diagnosis.residuals.tolerance import Tolerance, without_each
from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

STEPS = (1e-3, 0.03)
"""Changes of the start positions [rad] and start velocities [rad/s] of simulations by
which the influence of a wrong start is measured."""

SPREADS = (2e-3, 0.3)
"""Standard deviations of the errors of start positions [rad] and velocities [rad/s]."""


def nudged(runs: Sequence[Run], joints: Sequence[Sequence[int]]) -> list[list[Run]]:
    """The windows with other start positions, then with other start velocities.

    A list of windows for each change: first the positions of each group of `joints`
    (indices) in turn, then their velocities. Groups hold joints that do not move each
    other.
    """
    changes = []
    for field, step in zip(("position_rad", "velocity_rad_s"), STEPS, strict=True):
        for group in joints:
            more = np.zeros_like(runs[0].position_rad)
            more[list(group)] = step
            changes.append(
                [replace(run, **{field: getattr(run, field) + more}) for run in runs]
            )
    return changes


class StartUncertainty:
    """Courses of the error (signatures) by wrong start states, window by window."""

    def __init__(
        self,
        changes: FloatArray,
        ends: Sequence[int],
        whiten: Callable[[FloatArray], FloatArray] | None = None,
    ) -> None:
        """Prepare the whitening.

        `changes` (k, rows, c) of the simulated channels, in units of noise and 0 where
        errors do not count, are those by start positions, then by start velocities that
        are wrong by one standard deviation; `ends` are the rows after each window.
        What whitens residuals before, such as for errors of the clock, is `whiten`.
        """
        self._changes, self._ends = changes, list(ends)
        timed = changes if whiten is None else whiten(changes)
        self._windows = [
            (
                last - first,
                Tolerance(Changes.of(timed[:, first:last].reshape(len(timed), -1))),
            )
            for first, last in itertools.pairwise([0, *ends])
        ]

    def part(self, first: int, last: int) -> "StartUncertainty":
        """The start uncertainty of the windows `first` to `last - 1` only."""
        some, ends = copy(self), [0, *self._ends]
        some._windows = self._windows[first:last]
        some._changes = self._changes[:, ends[first] : ends[last]]
        some._ends = [end - ends[first] for end in ends[first + 1 : last + 1]]
        return some

    def evenly(self) -> "StartUncertainty":
        """The start uncertainty of residuals that were not whitened for a clock."""
        return StartUncertainty(self._changes, self._ends)

    @property
    def taken(self) -> float:
        """Number of the entries' squares that whitening takes out of noise."""
        return sum(tolerance.taken for _, tolerance in self._windows)

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals, whitened."""
        return without_each(self._windows, residual)
