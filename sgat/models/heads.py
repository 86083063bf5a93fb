"""What a network's last layer means: the parameters of a distribution.

Everything here is in scaled units. The parameters are taken out of the raw outputs
with torch while training and with NumPy afterwards: `xp` is the one or the other, and
only what both know by the same name is used.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import torch.distributions as td
from torch import Tensor

from groundwalk.arrays import FloatArray
from sgat.models.network import Float32Array

Parts: TypeAlias = tuple[Any, ...]
"""The parameters of n distributions."""

LOG_VARIANCE = (-7.0, 4.0)
"""Bounds of a log-variance in scaled units: standard deviations of 0.03 to 7.

Without them a network's spread away from its data is whatever it extrapolates to, and
a sampled state can be anything. A lower least variance makes covariances that are
nearly singular so stiff that the large variances are learned badly: with -10, those of
noise on a single action came out a third too wide.
"""


def bounded(raw: Any, xp: Any) -> Any:
    """Raw numbers softly bounded to `LOG_VARIANCE`, with slope 1 in the middle."""
    low, high = LOG_VARIANCE
    middle, half = (low + high) / 2, (high - low) / 2
    return middle + half * xp.tanh((raw - middle) / half)


@dataclass(frozen=True)
class Head(ABC):
    """A family of distributions over d numbers.

    Attributes:
      dimensions: d.
    """

    dimensions: int

    @property
    @abstractmethod
    def width(self) -> int:
        """How many raw outputs describe one distribution."""

    @abstractmethod
    def parts(self, raw: Any, xp: Any) -> Parts:
        """The parameters that the raw outputs (..., width) stand for."""

    @abstractmethod
    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) log p(y) of y (..., d), by torch's own distribution."""

    def loss(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) what training makes small: the negative log-likelihood."""
        return -self.log_density(parts, y)

    def mean(self, raw: Any, xp: Any) -> Any:
        """(..., d) of raw outputs (..., width); as a rule they start with it."""
        return raw[..., : self.dimensions]

    def mean_slope(self, raw: Float32Array, slope: Float32Array) -> Float32Array:
        """(n, d, a) derivative of the mean, of the raw outputs' (n, width, a)."""
        return slope[:, : self.dimensions]

    @abstractmethod
    def covariance(self, parts: Parts) -> FloatArray:
        """(n, d, d)."""

    @abstractmethod
    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) made of standardised residuals z (n, d) and uniform choices (n,)."""

    @abstractmethod
    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) the z that `sample` would have made the (n, d) y of."""


@dataclass(frozen=True)
class GaussianHead(Head):
    """Independent normal distributions: the paper's.

    Attributes:
      beta: weight of each dimension's loss by variance^beta, without its gradient:
        where the spread is large the mean still learns (Seitzer et al. 2022, eq. 5).
        0 is the likelihood itself.
    """

    beta: float = 0.0

    @property
    def width(self) -> int:
        """Mean and log-variance."""
        return 2 * self.dimensions

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Mean and standard deviation, (..., d) each."""
        mean, log_variance = raw[..., : self.dimensions], raw[..., self.dimensions :]
        return mean, xp.exp(bounded(log_variance, xp) / 2)

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """See `Head`."""
        density: Tensor = self._log_densities(parts, y).sum(dim=-1)
        return density

    def loss(self, parts: Parts, y: Tensor) -> Tensor:
        """See `Head` and `beta`."""
        weight = parts[1].detach() ** (2 * self.beta)
        loss: Tensor = -(weight * self._log_densities(parts, y)).sum(dim=-1)
        return loss

    @staticmethod
    def _log_densities(parts: Parts, y: Tensor) -> Tensor:
        mean, deviation = parts
        normal = td.Normal(mean, deviation, validate_args=False)
        densities: Tensor = normal.log_prob(y)  # type: ignore[no-untyped-call]
        return densities

    def covariance(self, parts: Parts) -> FloatArray:
        """See `Head`."""
        return np.asarray(parts[1][..., None] ** 2 * np.eye(self.dimensions))

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """See `Head`."""
        return np.asarray(parts[0] + parts[1] * z)

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """See `Head`."""
        return np.asarray((y - parts[0]) / parts[1])


class FullHead(Head):
    """One normal distribution with any covariance L L^T."""

    @property
    def width(self) -> int:
        """Mean, log-variances on L's diagonal, and what is below it."""
        return self.dimensions * (self.dimensions + 3) // 2

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Mean (..., d) and the lower triangle L (..., d, d)."""
        d = self.dimensions
        factor = xp.zeros((*raw.shape[:-1], d, d), dtype=raw.dtype)
        diagonal, (row, column) = np.arange(d), np.tril_indices(d, -1)
        factor[..., diagonal, diagonal] = xp.exp(bounded(raw[..., d : 2 * d], xp) / 2)
        factor[..., row, column] = raw[..., 2 * d :]
        return raw[..., :d], factor

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """See `Head`."""
        mean, factor = parts
        normal = td.MultivariateNormal(mean, scale_tril=factor, validate_args=False)
        return normal.log_prob(y)  # type: ignore[no-untyped-call, no-any-return]

    def covariance(self, parts: Parts) -> FloatArray:
        """See `Head`."""
        return np.asarray(parts[1] @ parts[1].swapaxes(-1, -2))

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """See `Head`."""
        return np.asarray(parts[0] + (parts[1] @ z[..., None])[..., 0])

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """See `Head`."""
        return np.linalg.solve(parts[1], (y - parts[0])[..., None])[..., 0]


@dataclass(frozen=True)
class LowRankHead(Head):
    """One normal distribution with the covariance U U^T + D, D diagonal.

    Attributes:
      rank: columns of U, the number of disturbances that move all dimensions at once.
    """

    rank: int = 2

    @property
    def width(self) -> int:
        """Mean, log-variances of D, and U."""
        return self.dimensions * (2 + self.rank)

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Mean (..., d), U (..., d, rank) and D's diagonal (..., d)."""
        d = self.dimensions
        factor = raw[..., 2 * d :].reshape((*raw.shape[:-1], d, self.rank))
        return raw[..., :d], factor, xp.exp(bounded(raw[..., d : 2 * d], xp))

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """See `Head`."""
        mean, factor, variance = parts
        normal = td.LowRankMultivariateNormal(
            mean, factor, variance, validate_args=False
        )
        return normal.log_prob(y)  # type: ignore[no-untyped-call, no-any-return]

    def covariance(self, parts: Parts) -> FloatArray:
        """See `Head`."""
        _, factor, variance = parts
        factor = factor.astype(float)  # the triangle of a nearly singular matrix
        shared = factor @ factor.swapaxes(-1, -2)
        return np.asarray(shared + variance[..., None] * np.eye(self.dimensions))

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """See `Head`."""
        return FullHead(self.dimensions).sample(self._triangular(parts), z, choice)

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """See `Head`."""
        return FullHead(self.dimensions).residuals(self._triangular(parts), y, choice)

    def _triangular(self, parts: Parts) -> Parts:
        return parts[0], np.linalg.cholesky(self.covariance(parts))
