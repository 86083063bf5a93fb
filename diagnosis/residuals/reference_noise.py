"""Reference noise: model error that recordings of the healthy robot show already.

A model is never exact: engines differ in contacts, start states are known up to sensor
noise, and real robots have friction that their model lacks. Effects that explain a part
of this error become part of the nominal model. The rest counts as noise with its size
and shape: residuals are whitened by its covariance (generalised least squares, Aitken
1936). Then an error that was present before is no evidence, however large, and a new
error is as much evidence as the sensors' noise allows.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.torques.healthy_torques import HealthyTorques
from diagnosis.traces.windows import FLOATING_WINDOW_S, Run
from groundwalk.arrays import BoolArray, FloatArray, IntArray
from groundwalk.distributions import chi2_sf
from groundwalk.errors import BadRecordingError

WAVES = 4
"""Number of Legendre polynomials that describe the smooth part of a channel's model
error in a block of 0.3 s; faster parts count as white noise."""

FEWEST_ROWS = 2 * WAVES
"""Fewest rows of a 0.3 s block in which the smooth part of an error is described."""

LEVEL = 0.05
"""Probability at which noise alone would make recordings differ as much."""

TOO_SHORT = "the reference recordings are too short to learn the model error from"

SHRINKAGES = (0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Shrinkages of an error covariance towards its diagonal that are tried. It is learned
from fewer blocks of data than it has rows, hence it needs some shrinkage."""


@dataclass(frozen=True, eq=False)
class Block:
    """Consecutive rows of a recording whose errors are correlated.

    Attributes:
      rows: their indices among all rows of a predictor.
      waves: (rows, waves) polynomials of time, orthonormal over the rows that count, 0
        in the others; no columns if too few rows count.
    """

    rows: slice
    waves: FloatArray


def blocks_of(runs: Sequence[Run], scored: BoolArray) -> list[Block]:
    """Windows of recordings, cut into blocks of 0.3 s.

    `scored` (rows of all windows,) says whether errors in a row count in any channel.
    """
    blocks, first = [], 0
    for run in runs:
        since_s = (run.trace.time_s - run.trace.time_s[0])[run.trace.compared]
        number = (since_s / FLOATING_WINDOW_S).astype(int)
        starts = np.flatnonzero(np.diff(number, prepend=-1))
        for start, stop in itertools.pairwise([*starts.tolist(), len(number)]):
            rows = slice(first + start, first + stop)
            within = since_s[start:stop] / FLOATING_WINDOW_S - number[start]
            blocks.append(Block(rows, waves(within, scored[rows])))
        first += len(number)
    return blocks


def waves(within: FloatArray, scored: BoolArray) -> FloatArray:
    """(rows, waves) Legendre polynomials over [0, 1), orthonormal on scored rows."""
    if scored.sum() < FEWEST_ROWS:
        return np.zeros((len(within), 0))
    values = np.polynomial.legendre.legvander(2 * within - 1, WAVES - 1)
    found = np.zeros_like(values)
    found[scored] = np.linalg.qr(values[scored])[0]
    # the sign of each column is arbitrary, but has to be the same in all blocks
    return np.asarray(found * np.sign(np.sum(found * values, axis=0)))


@dataclass(frozen=True, eq=False)
class ReferenceNoise:
    """Errors in c channels that the robot model makes for the healthy robot.

    Within a block of 0.3 s a smooth error is a sum of polynomials (waves); faster
    errors are white noise.

    Attributes:
      model: effects that count as part of the nominal model.
      scale: (c,) rms of the fast errors in units of sensor noise; at least 1.
      power: (k,) variances of the smooth errors along `axes`, in units of (sensor noise
        times `scale`) squared; at least 1.
      axes: (waves c, k) orthonormal directions, in coefficients of waves and channels.
      rows: median number of rows of the blocks from which these were learned.
      spread: (k, k) covariance, in usual standard deviations, of what is left unknown
        of small mismatch of the robot model, and after it, in scaled coordinates, of
        the values of `found`; None if nothing was learned of it.
      found: those effects of `model` whose values were free.
      healthy: errors in torque, if torques are compared and the robot's model is far
        from it; then all others are none.
    """

    model: tuple[PlacedEffect, ...]
    scale: FloatArray
    power: FloatArray
    axes: FloatArray
    rows: float
    spread: FloatArray | None = None
    healthy: HealthyTorques | None = None
    found: tuple[PlacedEffect, ...] = ()

    @classmethod
    def known(cls, model: tuple[PlacedEffect, ...], channels: int) -> "ReferenceNoise":
        """Effects that count as part of the nominal model, without further errors."""
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
        """Learn the errors from residuals of recordings of the healthy robot.

        The residual (rows, c) of the model is in units of noise; `scored` (rows, c)
        says whether an entry counts.

        Raises:
          BadRecordingError: no block has enough rows that count.
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

    def knowing(
        self,
        changes: FloatArray,
        residual: FloatArray,
        blocks: Sequence[Block],
        recording: IntArray,
        found: tuple[PlacedEffect, ...] = (),
    ) -> "ReferenceNoise":
        """With what the recordings leave unknown of the model.

        The robot has the same errors in other recordings, but for what recordings
        differ by. That makes what they tell together less sure, and others, taken to be
        as many, differ from it as much again.

        Args:
          changes: (k, rows, c) those of the residual, in units of noise, by one usual
            standard deviation of each error of the model, beside the likely errors;
            then those by the values of the effects `found`.
          residual: (rows, c) what the model leaves, in units of noise.
          blocks: windows of the recordings, as for `of`.
          recording: (rows,) number of the recording of each row.
          found: the effects of the model whose values are free.
        """
        seen = self.without(changes, blocks)
        (left,) = self.without(residual[None], blocks)
        flat = seen.reshape(len(seen), -1)
        spread = np.asarray(np.linalg.inv(np.eye(len(seen)) + flat @ flat.T), float)
        apart = _apart(spread, seen, left, recording)
        spread = spread + 2 * apart.T @ apart
        return replace(self, spread=spread, found=found)

    def without(self, residual: FloatArray, blocks: Sequence[Block]) -> FloatArray:
        """(n, rows, c) residuals in units of noise, whitened by the covariance."""
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
        """(waves c, waves c) I - C^(-1/2), with C the covariance of smooth errors.

        C is that in a block of `rows` rows; the variances grow with that number.
        """
        power = 1 + (self.power - 1) * rows / self.rows
        return np.asarray((self.axes * (1 - 1 / np.sqrt(power))) @ self.axes.T)


def _apart(
    spread: FloatArray, seen: FloatArray, left: FloatArray, recording: IntArray
) -> FloatArray:
    """(r, k) shares of r recordings in how far k values may be off; 0 by noise alone.

    Their products' sum is the covariance of the values if recordings differ (Liang and
    Zeger 1986, "Longitudinal data analysis using generalized linear models"). Arguments
    are whitened ones of `ReferenceNoise.knowing`.
    """
    numbers = np.unique(recording)
    parts, count = [recording == number for number in numbers], len(numbers)
    pulls = np.array([np.einsum("krc,rc->k", seen[:, p], left[p]) for p in parts])
    apart = pulls - pulls.mean(axis=0)
    each = [seen[:, p].reshape(len(seen), -1) for p in parts]
    told = sum(float(np.sum((spread @ one) * one)) for one in each)
    scatter = count * float(np.sum((apart @ spread) * apart))
    if chi2_sf(scatter, max(told * (count - 1), 1e-12)) > LEVEL:
        return np.zeros_like(apart)
    return np.asarray(apart @ spread / np.sqrt(1 - 1 / count))


def _covariance(smooth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(k,) variances and (k, k) principal axes of (blocks, k) values.

    Their covariance is shrunk towards its diagonal as cross-validation chooses: under
    the covariance learned from one half of the blocks the other half is most likely.
    """
    half = len(smooth) // 2
    parts = [smooth[:half], smooth[half:]]

    def surprise(shrinkage: float) -> float:
        pairs = (parts, parts[::-1])
        return sum(_surprise(one, *_shrunk(other, shrinkage)) for one, other in pairs)

    return _shrunk(smooth, min(SHRINKAGES, key=surprise) if half else 1.0)


def _shrunk(smooth: FloatArray, shrinkage: float) -> tuple[FloatArray, FloatArray]:
    """(k,) variances and (k, k) principal axes of the shrunk second moments."""
    moments = smooth.T @ smooth / len(smooth)
    diagonal = np.diag(np.maximum(np.diag(moments), 1.0))
    power, axes = np.linalg.eigh((1 - shrinkage) * moments + shrinkage * diagonal)
    return np.maximum(power, 1.0), axes


def _surprise(smooth: FloatArray, power: FloatArray, axes: FloatArray) -> float:
    """Minus the log-likelihood [nats] of (blocks, k) values, up to a constant."""
    seen = smooth @ axes
    return float(0.5 * np.sum(seen**2 / power) + 0.5 * len(seen) * np.log(power).sum())
