"""Removes from residuals the influence of uncertain start states of the simulation.

A simulation starts from measured positions, known up to sensor noise, and velocities,
known less well. The error of a wrong start fades within moments on well damped servos
and lasts for seconds on others. Its course (signature) is measured once, and the part
of a residual that has this course is removed.
"""

import itertools
from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

STEPS = (1e-3, 0.03)
"""Changes of the start positions [rad] and start velocities [rad/s] of simulations by
which the influence of a wrong start is measured."""

SPREADS = (2e-3, 0.3)
"""Standard deviations of the errors of start positions [rad] and velocities [rad/s]."""


def nudged(runs: Sequence[Run]) -> list[Run]:
    """The windows unchanged, with other start positions, and with other velocities.

    Three times as many windows, in this order. All joints' starts are changed at once:
    servos are stiff, so that each joint hardly moves the others.
    """
    dq, dv = STEPS
    positions = [replace(run, position_rad=run.position_rad + dq) for run in runs]
    speeds = [replace(run, velocity_rad_s=run.velocity_rad_s + dv) for run in runs]
    return [*runs, *positions, *speeds]


class StartUncertainty:
    """Courses of the error (signatures) by wrong start states, window by window."""

    def __init__(self, changes: Sequence[FloatArray], ends: Sequence[int]) -> None:
        """Prepare the projection that removes the signatures.

        `changes` (rows, c) of the simulated channels, in units of noise and 0 where
        errors do not count, are those by start positions, then by start velocities that
        are wrong by one standard deviation; `ends` are the rows after each window.
        """
        signatures = np.stack(changes)
        self._windows = []
        for first, last in itertools.pairwise([0, *ends]):
            own = signatures[:, first:last]
            # 1 on the diagonal is the prior: a standard normal error of the start
            gram = np.einsum("krc,lrc->ckl", own, own) + np.eye(len(own))
            self._windows.append((own, np.linalg.inv(gram)))

    def part(self, first: int, last: int) -> "StartUncertainty":
        """The start uncertainty of the windows `first` to `last - 1` only."""
        some = copy(self)
        some._windows = self._windows[first:last]
        return some

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals less the part that wrong start states explain."""
        cleaned, first = [], 0
        for own, inverse in self._windows:
            last = first + own.shape[1]
            part = residual[:, first:last]
            seen = np.einsum("krc,nrc->nck", own, part)
            size = np.einsum("ckl,ncl->nck", inverse, seen)
            cleaned.append(part - np.einsum("krc,nck->nrc", own, size))
            first = last
        return np.concatenate(cleaned, axis=1)
