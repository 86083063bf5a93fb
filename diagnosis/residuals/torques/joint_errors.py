"""One joint's torque errors, as a regression that differs between recordings.

A joint's mean torque errors y are X (b + d) + e: b are the robot's coefficients, d what
those of a recording differ from these, e noise that is alike in successive means. Given
the variances of all three, what is expected of each is known in closed form.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from groundwalk.arrays import FloatArray, IntArray

COLUMNS = (
    "constant",
    "speed",
    "sign",
    "angle",
    "sine",
    "cosine",
    "acceleration",
    "torque",
    "load",
    "command",
)
"""What a joint's torque error may be in proportion to. It covers friction, springs,
weight, wrong gains and inertia, friction that grows with the load, late commands."""

TINY = 1e-12
"""Least size of what is divided by."""


@dataclass(frozen=True, eq=False)
class Means:
    """Mean torque errors of joints in blocks of successive rows, and what they go with.

    Attributes:
      missing: (n, j) measured less needed torque; NaN where a mean does not count.
      columns: (n, j, k) values of `COLUMNS` for each joint.
      torque: (n, j) the needed torque, for the scale.
      recording: (n,) number of the recording of each block.
      block: (n,) number of the block, without gaps in time.
      names: names of the recordings.
    """

    missing: FloatArray
    columns: FloatArray
    torque: FloatArray
    recording: IntArray
    block: IntArray
    names: tuple[str, ...]

    def and_of(self, other: "Means") -> "Means":
        """All means, of these and of other recordings."""
        later = len(self.names)
        return Means(
            np.concatenate([self.missing, other.missing]),
            np.concatenate([self.columns, other.columns]),
            np.concatenate([self.torque, other.torque]),
            np.concatenate([self.recording, other.recording + later]),
            np.concatenate([self.block, other.block]),
            (*self.names, *other.names),
        )


@dataclass(frozen=True, eq=False)
class Expected:
    """Expected squares of one joint, given variances.

    Attributes:
      robot: (k,) those of the robot's coefficients.
      recordings: (k,) those of what each recording's differ from these.
      left: (r, 2) sums of those of what regression leaves of recordings, whitened, and
        numbers of means.
      products: sums of products of successive ones, and of squares of the first.
      evidence: logarithm of the likelihood of the joint's means, in its units.
    """

    robot: FloatArray
    recordings: list[FloatArray]
    left: FloatArray
    products: tuple[float, float]
    evidence: float


@dataclass(frozen=True, eq=False)
class JointErrors:
    """Means of one joint, by recording, in units of its torque and its columns' rms."""

    unit: float
    size: FloatArray
    x: list[FloatArray]
    y: list[FloatArray]
    gaps: list[IntArray]

    @classmethod
    def of(
        cls, means: Means, joint: int, like: "JointErrors | None" = None
    ) -> "JointErrors":
        """The joint's means that count, in units of another one if given."""
        there = np.isfinite(means.missing[:, joint])
        x, y = means.columns[there, joint], means.missing[there, joint]
        if like is None:
            torque = means.torque[:, joint]
            unit = max(float(np.sqrt(np.mean(torque**2))), TINY)
            size = np.maximum(_rms(x), TINY)
        else:
            unit, size = like.unit, like.size
        own = means.recording[there]
        parts = [own == k for k in range(len(means.names))]
        block = means.block[there]
        return cls(
            unit,
            size,
            [x[part] / size for part in parts],
            [y[part] / unit for part in parts],
            [np.diff(block[part]) for part in parts],
        )

    def expected(
        self, usual: FloatArray, between: FloatArray, left: FloatArray, alike: float
    ) -> Expected:
        """Expected squares given the variances of all random terms."""
        k, count = len(usual), len(self.x)
        white = [
            (_white(x, gaps, alike), _white(y, gaps, alike))
            for x, y, gaps in zip(self.x, self.y, self.gaps, strict=True)
        ]
        grams = [x.T @ x / s2 for (x, _), s2 in zip(white, left, strict=True)]
        seen = [x.T @ y / s2 for (x, y), s2 in zip(white, left, strict=True)]
        precision = np.diag(np.concatenate([1 / usual, *[1 / between] * count]))
        whole = np.zeros(len(precision))
        for i, (gram, one) in enumerate(zip(grams, seen, strict=True)):
            own = slice((i + 1) * k, (i + 2) * k)
            precision[:k, :k] += gram
            precision[own, own] += gram
            precision[:k, own] = precision[own, :k] = gram
            whole[:k] += one
            whole[own] = one
        unknown = np.linalg.inv(precision)
        mean = unknown @ whole
        squares = mean**2 + np.diag(unknown)
        total = np.zeros((count, 2))
        products = np.zeros(2)
        for i, (x, y) in enumerate(white):
            own = slice((i + 1) * k, (i + 2) * k)
            rest = y - x @ (mean[:k] + mean[own])
            spread = (
                unknown[:k, :k]
                + unknown[own, own]
                + unknown[:k, own]
                + unknown[own, :k]
            )
            wrong = float(rest @ rest) + left[i] * float(np.sum(spread * grams[i]))
            total[i] = wrong, len(y)
            bare = self.y[i] - self.x[i] @ (mean[:k] + mean[own])
            near = self.gaps[i] == 1
            products += (
                float(np.sum((bare[1:] * bare[:-1])[near])),
                float(np.sum((bare[:-1] ** 2)[near])),
            )
        return Expected(
            squares[:k],
            [squares[(i + 1) * k : (i + 2) * k] for i in range(count)],
            total,
            (float(products[0]), float(products[1])),
            self._evidence(white, (usual, between, left, alike), precision, whole),
        )

    @property
    def logarithm(self) -> float:
        """What the joint's unit changes in the logarithm of a likelihood."""
        return float(np.log(self.unit)) * sum(map(len, self.y))

    def _evidence(
        self,
        white: Sequence[tuple[FloatArray, FloatArray]],
        variances: tuple[FloatArray, FloatArray, FloatArray, float],
        precision: FloatArray,
        whole: FloatArray,
    ) -> float:
        """Logarithm of the likelihood of the means [nats], up to a constant."""
        usual, between, left, alike = variances
        squares = sum(float(y @ y) / s2 for (_, y), s2 in zip(white, left, strict=True))
        squares -= float(whole @ np.linalg.solve(precision, whole))
        spread = np.linalg.slogdet(precision)[1] + np.log(usual).sum()
        spread += len(white) * np.log(between).sum()
        for (_, y), gaps, s2 in zip(white, self.gaps, left, strict=True):
            spread += len(y) * np.log(s2) + np.log(1 - alike ** (2.0 * gaps)).sum()
        return -0.5 * float(squares + spread)

    def robot_of(
        self, usual: FloatArray, between: FloatArray, left: FloatArray, alike: float
    ) -> tuple[FloatArray, FloatArray]:
        """(k,) likely coefficients of the robot, and their (k, k) covariance."""
        precision, whole = np.diag(1 / usual), np.zeros(len(usual))
        for x, y, gaps, s2 in zip(self.x, self.y, self.gaps, left, strict=True):
            white = _white(x, gaps, alike)
            gram = white.T @ white / s2
            seen = white.T @ _white(y, gaps, alike) / s2
            inner = np.linalg.solve(
                np.diag(1 / between) + gram, np.column_stack([gram, seen])
            )
            precision = precision + gram - gram @ inner[:, :-1]
            whole = whole + seen - gram @ inner[:, -1]
        unknown = np.linalg.inv(precision)
        return np.asarray(unknown @ whole), np.asarray(unknown)


def _white(values: FloatArray, gaps: IntArray, alike: float) -> FloatArray:
    """(n, ...) values in time, whitened of noise that is alike in successive ones."""
    if len(values) < 2:
        return values
    share = (alike**gaps).reshape(-1, *[1] * (values.ndim - 1))
    found = values.copy()
    found[1:] = (values[1:] - share * values[:-1]) / np.sqrt(1 - share**2)
    return found


def _rms(values: FloatArray) -> FloatArray:
    """(k,) root mean squares of (n, k) values; 0 without any."""
    return np.asarray(np.sqrt(np.sum(values**2, axis=0) / max(len(values), 1)))
