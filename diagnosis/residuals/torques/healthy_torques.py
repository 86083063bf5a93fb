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

from diagnosis.residuals.torques.joint_errors import (
    COLUMNS,
    TINY,
    Expected,
    JointErrors,
    Means,
)
from groundwalk.arrays import FloatArray

STEADY = COLUMNS.index("command")
"""The column whose coefficients do not differ between recordings: a bus is as slow in
all of them."""

ROUNDS = 150
"""Rounds of expectation and maximisation (Dempster, Laird and Rubin 1977)."""

USUAL, USUAL_COUNT = 0.1, 2.0
"""Usual size of the robot's coefficients, as a share of the joint's torque, and the
number of coefficients that this is worth."""

BETWEEN, BETWEEN_COUNT = 0.02, 2.0
"""Usual differences of coefficients between recordings, as a share of the joint's
torque, and the number of differences that this is worth."""

ALIKE_COUNT = 5.0
"""Number of means that what is usual for the other joints is worth, for the variance
that regression leaves of a joint."""

FAR = 1e4
"""Standard deviations of the noise by which an unknown coefficient changes torques at
most: whatever goes with it is no evidence by then, and more is lost to rounding."""

LEAST = 0.01
"""Smallest rms that it leaves, as a share of the joint's torque."""


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
        joints = [JointErrors.of(both, j) for j in range(both.missing.shape[1])]
        count = len(COLUMNS)
        usual, between = np.full(count, USUAL**2), np.full(count, BETWEEN**2)
        between[STEADY] = TINY
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
            between[STEADY] = TINY
            left, alike = _left(found)
        evidence = sum(
            one.expected(usual, between, left[j], alike).evidence - one.logarithm
            for j, one in enumerate(joints)
        )
        own = [JointErrors.of(healthy, j, one) for j, one in enumerate(joints)]
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
        rms = np.sqrt(
            [self.left_in.get(means.names[i], self.left)[joint] for i in own.tolist()]
        )
        # of what never moved in the healthy robot's recordings nothing is known
        size = np.sqrt(np.sum(x**2, axis=0) / max(len(x), 1))
        known = size / (FAR * rms.min(initial=np.inf))
        most = 1 / np.maximum(known, TINY)
        reach = np.sqrt(np.diag(self.unknown[joint]))
        less = np.minimum(1.0, most / np.maximum(reach, TINY))
        between = np.minimum(self.between[joint], most**2)
        covariance = x @ (self.unknown[joint] * less[:, None] * less) @ x.T
        apart = np.abs(means.block[there][:, None] - means.block[there])
        together = own[:, None] == own
        within = (x * between) @ x.T
        within += rms[:, None] * rms * self.alike**apart
        covariance += np.where(together, within, 0.0)
        lower = np.linalg.cholesky(covariance)
        return np.asarray(np.linalg.inv(lower))


def _pooled(squares: Sequence[FloatArray], usual: float, count: float) -> FloatArray:
    """(k,) variances: means of squares, with some of the usual size among them."""
    total = np.sum(squares, axis=0) + count * usual**2
    return np.asarray(total / (len(squares) + count))


def _left(found: Sequence[Expected]) -> tuple[FloatArray, float]:
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
