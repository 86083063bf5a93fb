"""Noise from a latent disturbance that lasts, hits all dimensions and has outliers."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from groundwalk.arrays import FloatArray, IntArray
from groundwalk.errors import BadValueError
from sgat.measures import (
    autocorrelation,
    cross_correlation,
    excess_kurtosis,
    lagged_pairs,
)
from sgat.noise import CHUNK_TICKS, Generators

_MOST_PERSISTENT = 0.99
_SMALLEST_EIGENVALUE = 1e-6


@dataclass(frozen=True, eq=False)
class LatentNoise:
    """First-order autoregressive noise with correlated Student-t innovations.

    x_t = p x_{t-1} + sqrt(1 - p^2) e_t in each dimension, e_t a multivariate t with
    unit variances. Then every dimension has variance 1 and autocorrelation p^k whatever
    the others do, dimensions i and j are correlated by
    R_ij sqrt(1 - p_i^2) sqrt(1 - p_j^2) / (1 - p_i p_j), and an outlier hits all
    dimensions of a tick, as a bump under a foot does.

    Attributes:
      persistence: (d,) p, the correlation from one tick to the next, in (-1, 1).
      correlation: (d, d) R of the innovations.
      freedom: degrees of freedom of the t distribution, above 4 so that it has a
        kurtosis; infinite for normal innovations.
    """

    persistence: FloatArray
    correlation: FloatArray
    freedom: float = math.inf

    def __post_init__(self) -> None:
        """Refuse what has no variance, and what is no correlation matrix."""
        d = self.dimensions
        if not (np.abs(self.persistence) < 1).all():
            raise BadValueError("persistence must be between -1 and 1")
        R = self.correlation
        if (
            R.shape != (d, d)
            or not np.allclose(R, R.T)
            or not np.allclose(np.diag(R), 1)
        ):
            raise BadValueError(f"correlation must be symmetric, {d} x {d}, with ones")
        if np.linalg.eigvalsh(R).min() < 1e-12:
            raise BadValueError("correlation must be positive definite")
        if not self.freedom > 4:
            raise BadValueError(f"freedom is {self.freedom}; it must be above 4")

    @classmethod
    def from_residuals(cls, residuals: FloatArray, episode: IntArray) -> Self:
        """The noise with the moments of (N, d) residuals.

        Taken are each dimension's correlation over one tick, the correlations across
        dimensions, and the mean kurtosis of the innovations. Where no autoregressive
        noise has the data's correlations (a dimension without memory cannot share
        all of one that has it), the nearest that exists is used.
        """
        p = autocorrelation(residuals, episode, 1)[0]
        p = np.clip(p, -_MOST_PERSISTENT, _MOST_PERSISTENT)
        now, before = lagged_pairs(residuals, episode, 1)
        excess = float(excess_kurtosis(now - p * before).mean())
        correlation = _nearest_correlation(cross_correlation(residuals) / _shared(p))
        return cls(p, correlation, 4 + 6 / excess if excess > 0 else math.inf)

    @property
    def dimensions(self) -> int:
        """How many numbers a tick has."""
        return len(self.persistence)

    def chunk(self, generators: Generators, last: FloatArray | None) -> FloatArray:
        """See `NoiseLaw`; a robot starts in the stationary distribution."""
        if last is None:
            start = np.linalg.cholesky(self.correlation * _shared(self.persistence))
            last = np.stack([start @ self._normal(g, 1)[0] for g in generators])
        factor = np.linalg.cholesky(self.correlation).astype(float)
        steps = np.stack([self._innovations(g, factor) for g in generators], axis=1)
        steps *= np.sqrt(1 - self.persistence**2)
        for step in steps:
            step += self.persistence * last
            last = step
        return steps

    def _normal(self, generator: np.random.Generator, ticks: int) -> FloatArray:
        return generator.standard_normal((ticks, self.dimensions))

    def _innovations(
        self, generator: np.random.Generator, factor: FloatArray
    ) -> FloatArray:
        """(ticks, d) multivariate t: normal, divided by one root of a chi-square."""
        normal = self._normal(generator, CHUNK_TICKS) @ factor.T
        if math.isinf(self.freedom):
            return normal
        chi_square = generator.chisquare(self.freedom, (CHUNK_TICKS, 1))
        return normal * np.sqrt((self.freedom - 2) / chi_square)


def _shared(persistence: FloatArray) -> FloatArray:
    """(d, d) stationary correlation over the innovations' correlation."""
    root = np.sqrt(1 - persistence**2)
    return np.asarray(np.outer(root, root) / (1 - np.outer(persistence, persistence)))


def _nearest_correlation(wanted: FloatArray) -> FloatArray:
    """A correlation matrix near the wanted one: without its negative eigenvalues."""
    values, vectors = np.linalg.eigh(wanted)
    positive = vectors * np.maximum(values, _SMALLEST_EIGENVALUE) @ vectors.T
    root = np.sqrt(np.diag(positive))
    return np.asarray(positive / np.outer(root, root))
