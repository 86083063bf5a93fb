"""Removes the influence of uncertain start states from residuals.

At the start of a window positions are known up to sensor noise, velocities less well.
The influence of a wrong start fades within moments on well damped servos and lasts for
seconds on others. Its shape (signature) is measured once, and the part of a residual
that has this shape is removed.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

POSITION_STEP_RAD, VELOCITY_STEP_RAD_S = 1e-3, 0.03
"""Changes of the start state with which the signatures are measured."""

POSITION_SPREAD_RAD, VELOCITY_SPREAD_RAD_S = 2e-3, 0.3
"""Standard deviations of the errors of a smoothed start state."""


def nudged(runs: Sequence[Run]) -> list[Run]:
    """All windows unchanged, then with changed positions, then with changed velocities.

    All joints are changed at once: servos are stiff, so that each one hardly moves the
    others.
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
    """Signatures of wrong start positions and velocities in each window and channel."""

    def __init__(self, changes: Sequence[FloatArray], ends: Sequence[int]) -> None:
        """Prepare the projection that removes the signatures.

        Args:
          changes: two arrays (rows, c) in units of noise, 0 where not scored. They are
            the change of the replays when positions, or velocities, start off by one
            standard deviation.
          ends: one past the last row of each window.
        """
        signatures = np.stack(changes)
        self._runs = [
            _RunUncertainty.of(signatures[:, first:last])
            for first, last in itertools.pairwise([0, *ends])
        ]

    def part(self, first: int, last: int) -> "StartUncertainty":
        """The signatures of windows `first` to `last - 1`."""
        some = object.__new__(StartUncertainty)
        some._runs = self._runs[first:last]
        return some

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals minus the part that wrong starts explain."""
        ends = np.cumsum([run.own.shape[1] for run in self._runs])
        parts = np.split(residual, ends[:-1], axis=1)
        cleaned = [
            run.without(part) for run, part in zip(self._runs, parts, strict=True)
        ]
        return np.concatenate(cleaned, axis=1)


@dataclass(frozen=True, eq=False)
class _RunUncertainty:
    """One window: (2, rows, c) signatures, (c, 2, 2) inverse of their products."""

    own: FloatArray
    inverse: FloatArray

    @classmethod
    def of(cls, own: FloatArray) -> Self:
        """Prepare the projection for (2, rows, c) signatures."""
        # 1 on the diagonal is the prior: a standard normal error of the start
        gram = np.einsum("krc,lrc->ckl", own, own) + np.eye(len(own))
        return cls(own, np.linalg.inv(gram))

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals of the window without the signatures."""
        seen = np.einsum("krc,nrc->nck", self.own, residual)
        size = np.einsum("ckl,ncl->nck", self.inverse, seen)
        return np.asarray(residual - np.einsum("krc,nck->nrc", self.own, size))
