"""The standing difference between a model and its robot: there when all was well.

A model is never exact: engines differ in contacts, start states are known to the
sensors' noise, real robots have a friction that their model lacks. What recordings of
the robot in good order show of it is known before a search begins. What effects explain
of it becomes part of the plant. The rest counts as noise, with its size and its shape:
residuals are whitened by its covariance (generalised least squares, Aitken 1936), so
that an error which was there before is no evidence, however large, and one that was
not is as much evidence as the sensors' noise allows.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from diagnosis.effects.parts import PlacedEffect
from diagnosis.traces.windows import FLOATING_WINDOW_S, Run
from groundwalk.arrays import BoolArray, FloatArray
from groundwalk.errors import BadRecordingError

WAVES = 4
"""Legendre polynomials that stand for the smooth part of a channel's error in a block;
what is quicker is taken as white."""

FEWEST_ROWS = 2 * WAVES
"""Shorter blocks have no smooth part of their own."""

TOO_SHORT = "the reference recordings are too short to tell what was wrong before"

SHRINKAGES = (0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Of the covariance towards its diagonal: blocks are fewer than its rows."""


@dataclass(frozen=True, eq=False)
class Block:
    """Some consecutive rows of a run whose errors go together.

    Attributes:
      rows: of the predictor.
      waves: (rows, waves) orthonormal over the rows that are scored, 0 elsewhere.
    """

    rows: slice
    waves: FloatArray


def blocks_of(runs: Sequence[Run], scored: BoolArray) -> list[Block]:
    """Runs cut into blocks of 0.3 s.

    Args:
      runs: whose rows follow one another.
      scored: (rows,) whether any channel is.
    """
    blocks, first = [], 0
    for run in runs:
        since_s = run.trace.time_s - run.trace.time_s[0]
        number = (since_s / FLOATING_WINDOW_S).astype(int)
        starts = np.flatnonzero(np.diff(number, prepend=-1))
        for start, stop in itertools.pairwise([*starts.tolist(), len(number)]):
            rows = slice(first + start, first + stop)
            within = since_s[start:stop] / FLOATING_WINDOW_S - number[start]
            blocks.append(Block(rows, _waves(within, scored[rows])))
        first += len(number)
    return blocks


def _waves(within: FloatArray, scored: BoolArray) -> FloatArray:
    """Polynomials of times in [0, 1), orthonormal over the scored rows."""
    if scored.sum() < FEWEST_ROWS:
        return np.zeros((len(within), 0))
    values = np.polynomial.legendre.legvander(2 * within - 1, WAVES - 1)
    found = np.zeros_like(values)
    found[scored] = np.linalg.qr(values[scored])[0]
    # the sign of each column is arbitrary, but has to be the same in all blocks
    return np.asarray(found * np.sign(np.sum(found * values, axis=0)))


@dataclass(frozen=True, eq=False)
class ReferenceNoise:
    """What a model of c channels gets wrong when all is well.

    Attributes:
      model: effects that are part of the plant.
      scale: (c,) rms of quick errors, in units of noise; at least 1.
      power: (k,) variances of smooth errors along `axes`, in units of noise times
        scale; at least 1.
      axes: (waves c, k) orthonormal.
      rows: of the blocks that these were learned from.
    """

    model: tuple[PlacedEffect, ...]
    scale: FloatArray
    power: FloatArray
    axes: FloatArray
    rows: float

    @classmethod
    def known(cls, model: tuple[PlacedEffect, ...], channels: int) -> "ReferenceNoise":
        """Nothing but effects."""
        none = np.zeros((WAVES * channels, 0))
        return cls(model, np.ones(channels), np.zeros(0), none, 1.0)

    @classmethod
    def of(
        cls,
        model: tuple[PlacedEffect, ...],
        residual: FloatArray,
        scored: BoolArray,
        blocks: Sequence[Block],
    ) -> "ReferenceNoise":
        """Learn from reference recordings.

        Args:
          model: that is part of the plant.
          residual: (rows, c) that it leaves, in units of noise.
          scored: (rows, c).
          blocks: of the rows.

        Raises:
          BadRecordingError: no block is long enough.
        """
        long = [block for block in blocks if block.waves.shape[1]]
        if not long:
            raise BadRecordingError(TOO_SHORT)
        quick = residual.copy()
        for block in blocks:
            smooth = block.waves @ (block.waves.T @ residual[block.rows])
            quick[block.rows] -= smooth
        freedom = scored.sum(axis=0) - WAVES * len(long)
        scale = np.sqrt((quick**2).sum(axis=0) / np.maximum(freedom, 1))
        scale = np.maximum(scale, 1.0)
        smooth = np.array(
            [(block.waves.T @ (residual[block.rows] / scale)).ravel() for block in long]
        )
        rows = float(np.median([len(block.waves) for block in long]))
        return cls(model, scale, *_covariance(smooth), rows)

    def without(self, residual: FloatArray, blocks: Sequence[Block]) -> FloatArray:
        """(n, rows, c) residuals, whitened."""
        white = residual / self.scale
        factors: dict[int, FloatArray] = {}
        for block in blocks:
            count, waves = block.waves.shape
            if not waves:
                continue
            if count not in factors:
                factors[count] = self._less(count)
            smooth = np.einsum("rw,nrc->nwc", block.waves, white[:, block.rows])
            taken = smooth.reshape(len(smooth), -1) @ factors[count]
            change = taken.reshape(smooth.shape)
            white[:, block.rows] -= np.einsum("rw,nwc->nrc", block.waves, change)
        return np.asarray(white)

    def _less(self, rows: int) -> FloatArray:
        """One less the inverse root of the covariance in a block of so many rows.

        A smooth error's power grows with the number of rows that see it.
        """
        power = 1 + (self.power - 1) * rows / self.rows
        return np.asarray((self.axes * (1 - 1 / np.sqrt(power))) @ self.axes.T)


def _covariance(smooth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Variances and axes of (blocks, k) values, shrunk as far as they ask for.

    The shrinkage is the one under which each half of the blocks is most likely, as
    seen from the other half.
    """
    half = len(smooth) // 2
    parts = [smooth[:half], smooth[half:]]
    best, chosen = np.inf, 1.0
    for shrinkage in SHRINKAGES if half else ():
        surprise = sum(
            _surprise(one, *_shrunk(other, shrinkage))
            for one, other in (parts, parts[::-1])
        )
        if surprise < best:
            best, chosen = surprise, shrinkage
    return _shrunk(smooth, chosen)


def _shrunk(smooth: FloatArray, shrinkage: float) -> tuple[FloatArray, FloatArray]:
    """Second moments: an error that is always the same counts as one, too."""
    moments = smooth.T @ smooth / len(smooth)
    diagonal = np.diag(np.maximum(np.diag(moments), 1.0))
    power, axes = np.linalg.eigh((1 - shrinkage) * moments + shrinkage * diagonal)
    return np.maximum(power, 1.0), axes


def _surprise(smooth: FloatArray, power: FloatArray, axes: FloatArray) -> float:
    """Minus the log-likelihood."""
    seen = smooth @ axes
    return float(0.5 * np.sum(seen**2 / power) + 0.5 * len(seen) * np.log(power).sum())
