"""What is not known of the states that runs start from, taken out of residuals.

A position is known at the start to the sensors' noise, a velocity worse. What a wrong
start changes dies away within moments on damped servos and lasts for seconds on others.
Its signature is measured once, and what looks like it is not held against a model.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from diagnosis.traces.windows import Run
from groundwalk.arrays import FloatArray

POSITION_STEP_RAD, VELOCITY_STEP_RAD_S = 1e-3, 0.03
POSITION_SPREAD_RAD, VELOCITY_SPREAD_RAD_S = 2e-3, 0.3
"""How wrong a smoothed start may be."""


def nudged(runs: Sequence[Run]) -> list[Run]:
    """Every run as it is, from other positions, and with other velocities.

    All joints at once: servos are stiff, so that each moves mostly itself.
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
    """Signatures of wrong starts, for each run and channel its own two."""

    def __init__(self, changes: Sequence[FloatArray], ends: Sequence[int]) -> None:
        """Work out what takes them out of residuals.

        Args:
          changes: (rows, c) each, in units of noise and zero where not scored: what a
            start that is off by one spread changes; of positions, and of velocities.
          ends: one past the last row of each run.
        """
        signatures = np.stack(changes)
        self._runs = [
            _RunUncertainty.of(signatures[:, first:last])
            for first, last in itertools.pairwise([0, *ends])
        ]

    def part(self, first: int, last: int) -> "StartUncertainty":
        """Of runs `first` to `last - 1` only."""
        some = object.__new__(StartUncertainty)
        some._runs = self._runs[first:last]
        return some

    def without(self, residual: FloatArray) -> FloatArray:
        """(n, rows, c) residuals less what wrong starts explain of them."""
        ends = np.cumsum([run.own.shape[1] for run in self._runs])
        parts = np.split(residual, ends[:-1], axis=1)
        cleaned = [
            run.without(part) for run, part in zip(self._runs, parts, strict=True)
        ]
        return np.concatenate(cleaned, axis=1)


@dataclass(frozen=True, eq=False)
class _RunUncertainty:
    """Of one run: (2, rows, c) signatures, and the inverse of their products."""

    own: FloatArray
    inverse: FloatArray

    @classmethod
    def of(cls, own: FloatArray) -> Self:
        # one on the diagonal: a start that is off by more than its spread is unlikely
        gram = np.einsum("krc,lrc->ckl", own, own) + np.eye(len(own))
        return cls(own, np.linalg.inv(gram))

    def without(self, residual: FloatArray) -> FloatArray:
        seen = np.einsum("krc,nrc->nck", self.own, residual)
        size = np.einsum("ckl,ncl->nck", self.inverse, seen)
        return np.asarray(residual - np.einsum("krc,nck->nrc", self.own, size))
