"""What the healthy robot's joints need or give beside the torque that a model states.

No model of a real robot is exact to the noise of its sensors. What a joint's torque
lacks goes with its own motion, much the same in all recordings but never quite: gears
warm up, loads change. So it is taken as a regression on the motion of which each
recording has its own coefficients, scattered around those of the robot (Laird and Ware
1982, "Random-effects models for longitudinal data"). How much they scatter is learned
of all joints together. A change then is what differs from the healthy robot by more
than its recordings differ among themselves.
"""

from collections.abc import Mapping, Sequence
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

STEADY = COLUMNS.index("command")
"""The column whose coefficients do not differ between recordings: a bus is as slow in
all of them."""

ROUNDS = 150
"""Rounds of expectation and maximisation (Dempster, Laird and Rubin 1977)."""

USUAL, USUAL_COUNT = 0.1, 2.0
"""Usual size of the robot's coefficients, as a share of the joint's torque, and the
number of coefficients that this is worth."""

BETWEEN, BETWEEN_COUNT = 0.02, 2.0
"""The same for the differences between recordings."""

ALIKE_COUNT = 5.0
"""Number of means that what is usual for the other joints is worth, for the variance
that regression leaves of a joint."""

LEAST = 0.01
"""Smallest rms that it leaves, as a share of the joint's torque."""

_TINY = 1e-12


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
        """These and the means of other recordings."""
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
class HealthyTorques:
    """The torque errors of a healthy robot, as one recording of it shows them.

    Torques and columns have the units of the `Means` from which they were learned.

    Attributes:
      mean: (j, k) coefficients that the robot has.
      unknown: (j, k, k) covariance of what is left unknown of these.
      between: (j, k) variances of the coefficients between recordings.
      left: (j,) variance of the means that regression leaves in most recordings.
      left_in: the same in those recordings of which it was learned, by their names.
      alike: correlation of what it leaves in successive blocks.
      evidence: logarithm of the likelihood [nats] of all means together, the healthy
        robot's and others'.
    """

    mean: FloatArray
    unknown: FloatArray
    between: FloatArray
    left: FloatArray
    left_in: Mapping[str, FloatArray]
    alike: float
    evidence: float

    @classmethod
    def of(cls, healthy: Means, other: Means | None = None) -> "HealthyTorques":
        """Learn the errors from recordings of the healthy robot.

        How much recordings differ is learned of `other` ones of the same robot as well,
        the coefficients of the healthy ones only.
        """
        both = healthy if other is None else healthy.and_of(other)
        joints = [_Joint.of(both, j) for j in range(both.missing.shape[1])]
        count = len(COLUMNS)
        usual, between = np.full(count, USUAL**2), np.full(count, BETWEEN**2)
        between[STEADY] = _TINY
        first = 4 * BETWEEN**2
        left, alike = np.full((len(joints), len(both.names)), first), 0.3
        for _ in range(ROUNDS):
            found = [
                one.expected(usual, between, left[j], alike)
                for j, one in enumerate(joints)
            ]
            usual = _pooled([one.robot for one in found], USUAL, USUAL_COUNT)
            every = [one for each in found for one in each.recordings]
            between = _pooled(every, BETWEEN, BETWEEN_COUNT)
            between[STEADY] = _TINY
            left, alike = _left(found)
        evidence = sum(
            one.expected(usual, between, left[j], alike).evidence - one.logarithm
            for j, one in enumerate(joints)
        )
        own = [_Joint.of(healthy, j, one) for j, one in enumerate(joints)]
        sure = [
            one.robot_of(usual, between, left[j, : len(one.x)], alike)
            for j, one in enumerate(own)
        ]
        units = np.array([one.unit for one in joints])
        sizes = np.array([one.size for one in joints])
        scale = units[:, None] / sizes
        return cls(
            np.array([one[0] for one in sure]) * scale,
            np.array([one[1] for one in sure]) * scale[:, :, None] * scale[:, None],
            between * scale**2,
            np.median(left, axis=1) * units**2,
            {
                name: left[:, len(healthy.names) + i] * units**2
                for i, name in enumerate(() if other is None else other.names)
            },
            alike,
            evidence,
        )

    def torque(self, columns: FloatArray) -> FloatArray:
        """(rows, j) torque errors of the healthy robot, from columns (rows, j, k)."""
        return np.asarray(np.einsum("njk,jk->nj", columns, self.mean))

    def whitening(self, means: Means) -> list[FloatArray]:
        """For each joint the (m, m) matrix that whitens its m means that count."""
        return [self._whitening(means, j) for j in range(len(self.left))]

    def _whitening(self, means: Means, joint: int) -> FloatArray:
        there = np.isfinite(means.missing[:, joint])
        x, own = means.columns[there, joint], means.recording[there]
        covariance = x @ self.unknown[joint] @ x.T
        apart = np.abs(means.block[there][:, None] - means.block[there])
        together = own[:, None] == own
        within = (x * self.between[joint]) @ x.T
        rms = np.sqrt(
            [self.left_in.get(means.names[i], self.left)[joint] for i in own.tolist()]
        )
        within += rms[:, None] * rms * self.alike**apart
        covariance += np.where(together, within, 0.0)
        lower = np.linalg.cholesky(covariance)
        return np.asarray(np.linalg.inv(lower))


@dataclass(frozen=True, eq=False)
class _Expected:
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
class _Joint:
    """Means of one joint, by recording, in units of its torque and its columns' rms."""

    unit: float
    size: FloatArray
    x: list[FloatArray]
    y: list[FloatArray]
    gaps: list[IntArray]

    @classmethod
    def of(cls, means: Means, joint: int, like: "_Joint | None" = None) -> "_Joint":
        """The joint's means that count, in units of another one if given."""
        there = np.isfinite(means.missing[:, joint])
        x, y = means.columns[there, joint], means.missing[there, joint]
        if like is None:
            torque = means.torque[:, joint]
            unit = max(float(np.sqrt(np.mean(torque**2))), _TINY)
            size = np.maximum(_rms(x), _TINY)
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
    ) -> _Expected:
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
        return _Expected(
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


def _pooled(squares: Sequence[FloatArray], usual: float, count: float) -> FloatArray:
    """(k,) variances: means of squares, with some of the usual size among them."""
    total = np.sum(squares, axis=0) + count * usual**2
    return np.asarray(total / (len(squares) + count))


def _left(found: Sequence[_Expected]) -> tuple[FloatArray, float]:
    """(j, r) variances that regression leaves of joints in recordings; correlation.

    What few means tell is drawn to what is usual for the joint in other recordings, and
    what few recordings tell to what is usual for other joints.
    """
    every = np.array([one.left for one in found])
    totals, counts = every[:, :, 0], every[:, :, 1]
    each = np.where(counts > 0, totals / np.maximum(counts, 1), np.nan)
    some = (counts > 0).any(axis=1)
    joint, usual = np.zeros(len(found)), LEAST**2
    if some.any():
        joint[some] = np.nanmedian(each[some], axis=1)
        usual = float(np.median(joint[some]))
    number = counts.sum(axis=1)
    joint = (number * joint + ALIKE_COUNT * usual) / (number + ALIKE_COUNT)
    left = (totals + ALIKE_COUNT * joint[:, None]) / (counts + ALIKE_COUNT)
    # each joint's share counts alike, whatever its noise
    ratios = [a / b for a, b in (one.products for one in found) if b > 0]
    alike = float(np.clip(np.median(ratios), 0.0, 0.95)) if ratios else 0.0
    return np.maximum(left, LEAST**2), alike


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
