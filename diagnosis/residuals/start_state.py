"""Removes from residuals the influence of uncertain start states of the simulation.

A simulation starts from measured positions, known up to sensor noise, and velocities,
known less well. The error of a wrong start fades within moments on well damped servos
and lasts for seconds on others. Its course (signature) is measured once, and the part
of a residual that has this course is removed.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

POSITION_STEP_RAD, VELOCITY_STEP_RAD_S = 1e-3, 0.03
"""Changes of the start positions [rad] and start velocities [rad/s] of simulations by
which the influence of a wrong start is measured."""

POSITION_SPREAD_RAD, VELOCITY_SPREAD_RAD_S = 2e-3, 0.3
"""Standard deviations of the errors of positions [rad] and velocities [rad/s] from
which simulations start."""


def nudged(runs: Sequence[Run]) -> list[Run]:
    """The windows unchanged, with other start positions, and with other velocities.

    All joints' starts are changed at once: servos are stiff, so that each joint hardly
    moves the others.

    Returns:
      Three times as many windows as `runs`, in this order.
    """
    positions = [
        replace(run, position_rad=run.position_rad + POSITION_STEP_RAD) for run in runs
    ]
    velocities = [
        replace(run, velocity_rad_s=run.velocity_rad_s + VELOCITY_STEP_RAD_S)
        for run in runs
    ]
    return [*runs, *positions, *velocities]


class StartUncertainty:
    """Courses of the error (signatures) by wrong start states, window by window."""

    def __init__(self, changes: Sequence[FloatArray], ends: Sequence[int]) -> None:
        """Prepare the projection that removes the signatures.

        Args:
          changes: changes (rows, c) of the simulated channels in units of noise, 0
            where errors do not count: first if the start positions are wrong by one
            standard deviation, then if the start velocities are.
          ends: row after the last one of each window.
        """
        signatures = np.stack(changes)
        self._runs = [
            _RunUncertainty.of(signatures[:, first:last])
            for first, last in itertools.pairwise([0, *ends])
        ]

    def part(self, first: int, last: int) -> "StartUncertainty":
        """The start uncertainty of the windows `first` to `last - 1` only."""
        some = object.__new__(StartUncertainty)
        some._runs = self._runs[first:last]
        return some

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals less the part that wrong start states explain."""
        ends = np.cumsum([run.own.shape[1] for run in self._runs])
        parts = np.split(residual, ends[:-1], axis=1)
        cleaned = [
            run.without(part) for run, part in zip(self._runs, parts, strict=True)
        ]
        return np.concatenate(cleaned, axis=1)


@dataclass(frozen=True, eq=False)
class _RunUncertainty:
    """Signatures of wrong start states in one window.

    Attributes:
      own: (2, rows, c) courses of the error, by position and by velocity.
      inverse: (c, 2, 2) inverse of their scalar products plus 1 on the diagonal.
    """

    own: FloatArray
    inverse: FloatArray

    @classmethod
    def of(cls, own: FloatArray) -> Self:
        """Prepare a projection that removes (2, rows, c) signatures of wrong starts."""
        # 1 on the diagonal is the prior: a standard normal error of the start
        gram = np.einsum("krc,lrc->ckl", own, own) + np.eye(len(own))
        return cls(own, np.linalg.inv(gram))

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals of the window without the signatures."""
        seen = np.einsum("krc,nrc->nck", self.own, residual)
        size = np.einsum("ckl,ncl->nck", self.inverse, seen)
        return np.asarray(residual - np.einsum("krc,nck->nrc", self.own, size))
