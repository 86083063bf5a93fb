"""Heads: how a network's raw outputs become the parameters of a distribution.

All numbers are scaled to mean 0 and standard deviation 1 of the training data. The
parameters are computed with torch during training and with NumPy afterwards: the
argument `xp` is one of the two modules.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import torch.distributions as td
from torch import Tensor

from groundwalk.arrays import FloatArray, IntArray

Parts: TypeAlias = tuple[Any, ...]
"""The parameters of n distributions, as arrays or tensors; each head has its own."""

LOG_VARIANCE = (-7.0, 4.0)
"""Bounds of a log-variance in scaled units: standard deviations from 0.03 to 7.

With -10, nearly singular covariances make training so stiff that the noise on a single
action was learned a third too large.
"""


def bounded(raw: Any, xp: Any) -> Any:
    """Softly limit raw numbers to the bounds `LOG_VARIANCE`; `xp` is numpy or torch."""
    low, high = LOG_VARIANCE
    middle, half = (low + high) / 2, (high - low) / 2
    return middle + half * xp.tanh((raw - middle) / half)


@dataclass(frozen=True)
class Head(ABC):
    """A family of distributions over d numbers, where d is `dimensions`."""

    dimensions: int

    @property
    @abstractmethod
    def width(self) -> int:
        """Number of raw outputs that describe one distribution."""

    @abstractmethod
    def parts(self, raw: Any, xp: Any) -> Parts:
        """Parameters from raw outputs (..., width), which are arrays of module `xp`."""

    @abstractmethod
    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) logarithm of the density of values y (..., d), computed with torch."""

    def loss(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) training loss of values y (..., d): the negative log-likelihood."""
        return -self.log_density(parts, y)

    def mean(self, raw: Any, xp: Any) -> Any:
        """(..., d) mean from raw outputs (..., width); usually the first d of them."""
        return raw[..., : self.dimensions]

    @abstractmethod
    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) samples of n distributions, made of standardised noise z (n, d).

        `choice` (n,), uniform from 0 to 1, chooses the components of mixtures.
        """

    @abstractmethod
    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) noise z for which `sample` would give the values y (n, d)."""


@dataclass(frozen=True)
class GaussianHead(Head):
    """Independent normal distributions, as in the SGAT paper.

    Each dimension's loss is weighted by variance^beta, without a gradient through the
    weight (Seitzer et al. 2022, eq. 5); with 0 it is the plain likelihood.
    """

    beta: float = 0.0

    @property
    def width(self) -> int:
        """Number of raw outputs: d means and d log-variances."""
        return 2 * self.dimensions

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Means and standard deviations, (..., d) each, from raw outputs (..., 2 d)."""
        mean, log_variance = raw[..., : self.dimensions], raw[..., self.dimensions :]
        return mean, xp.exp(bounded(log_variance, xp) / 2)

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) log-density of values y (..., d): the sum over the d dimensions."""
        density: Tensor = self._log_densities(parts, y).sum(dim=-1)
        return density

    def loss(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) negative log-likelihood of y (..., d), weighted by variance^beta."""
        weight = parts[1].detach() ** (2 * self.beta)
        loss: Tensor = -(weight * self._log_densities(parts, y)).sum(dim=-1)
        return loss

    @staticmethod
    def _log_densities(parts: Parts, y: Tensor) -> Tensor:
        mean, deviation = parts
        normal = td.Normal(mean, deviation, validate_args=False)
        densities: Tensor = normal.log_prob(y)  # type: ignore[no-untyped-call]
        return densities

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) samples: mean plus noise z (n, d) times standard deviation."""
        return np.asarray(parts[0] + parts[1] * z)

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) values y (n, d) minus the mean, divided by the standard deviation."""
        return np.asarray((y - parts[0]) / parts[1])


class FullHead(Head):
    """A normal distribution with any covariance L L^T, where L is lower triangular."""

    @property
    def width(self) -> int:
        """Number of raw outputs: means, log-variances (diagonal of L), rest of L."""
        return self.dimensions * (self.dimensions + 3) // 2

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Means (..., d) and lower triangles L (..., d, d), from raw (..., width)."""
        d = self.dimensions
        factor = xp.zeros((*raw.shape[:-1], d, d), dtype=raw.dtype)
        diagonal, (row, column) = np.arange(d), np.tril_indices(d, -1)
        factor[..., diagonal, diagonal] = xp.exp(bounded(raw[..., d : 2 * d], xp) / 2)
        factor[..., row, column] = raw[..., 2 * d :]
        return raw[..., :d], factor

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) log-density of values y (..., d) with the covariance L L^T."""
        mean, factor = parts
        normal = td.MultivariateNormal(mean, scale_tril=factor, validate_args=False)
        return normal.log_prob(y)  # type: ignore[no-untyped-call, no-any-return]

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) samples: mean plus L times noise z (n, d)."""
        return np.asarray(parts[0] + (parts[1] @ z[..., None])[..., 0])

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) noise z that solves L z = y - mean, for values y (n, d)."""
        return np.linalg.solve(parts[1], (y - parts[0])[..., None])[..., 0]


@dataclass(frozen=True)
class LowRankHead(Head):
    """A normal distribution with covariance U U^T + D: rank of U, and D diagonal."""

    rank: int = 2

    @property
    def width(self) -> int:
        """Number of raw outputs, for covariance U U^T + D: means, log D, then U."""
        return self.dimensions * (2 + self.rank)

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Means (..., d), U (..., d, rank), D's diagonal (..., d), from raw outputs."""
        d = self.dimensions
        factor = raw[..., 2 * d :].reshape((*raw.shape[:-1], d, self.rank))
        return raw[..., :d], factor, xp.exp(bounded(raw[..., d : 2 * d], xp))

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) log-density of values y (..., d) with the covariance U U^T + D."""
        mean, factor, variance = parts
        normal = td.LowRankMultivariateNormal(
            mean, factor, variance, validate_args=False
        )
        return normal.log_prob(y)  # type: ignore[no-untyped-call, no-any-return]

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) samples: mean plus the covariance's Cholesky factor times z (n, d)."""
        return FullHead(self.dimensions).sample(self._triangular(parts), z, choice)

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) noise z with L z = y - mean, L the covariance's Cholesky factor."""
        return FullHead(self.dimensions).residuals(self._triangular(parts), y, choice)

    def _triangular(self, parts: Parts) -> Parts:
        mean, factor, variance = parts
        factor = factor.astype(float)  # the Cholesky factor needs float64
        shared = factor @ factor.swapaxes(-1, -2)
        covariance = shared + variance[..., None] * np.eye(self.dimensions)
        return mean, np.linalg.cholesky(covariance)


_LARGEST_LOGIT = 8.0
"""Bound of the logit of a mixture's component, so that training can bring back a light
component."""


@dataclass(frozen=True)
class MixtureHead(Head):
    """Mixture of k normal distributions with independent dimensions (Bishop 1994)."""

    components: int = 3

    @property
    def width(self) -> int:
        """Number of raw outputs: k logits, then k times d means and log-variances."""
        return self.components * (1 + 2 * self.dimensions)

    def parts(self, raw: Any, xp: Any) -> Parts:
        """Weights (..., k), means and standard deviations (..., k, d) of components."""
        k, d = self.components, self.dimensions
        logits = _LARGEST_LOGIT * xp.tanh(raw[..., :k] / _LARGEST_LOGIT)
        weights = xp.exp(logits)
        weights = weights / weights.sum(-1)[..., None]
        rest = raw[..., k:].reshape((*raw.shape[:-1], 2, k, d))
        return weights, rest[..., 0, :, :], xp.exp(bounded(rest[..., 1, :, :], xp) / 2)

    def log_density(self, parts: Parts, y: Tensor) -> Tensor:
        """(...) log-density of values y (..., d) in the mixture."""
        weights, means, deviations = parts
        mixture = td.MixtureSameFamily(
            td.Categorical(weights, validate_args=False),
            td.Independent(td.Normal(means, deviations, validate_args=False), 1),
            validate_args=False,
        )
        return mixture.log_prob(y)  # type: ignore[no-untyped-call, no-any-return]

    def mean(self, raw: Any, xp: Any) -> Any:
        """(..., d) weighted mean of the components' means, from raw outputs."""
        weights, means, _ = self.parts(raw, xp)
        return (weights[..., None] * means).sum(-2)

    def sample(self, parts: Parts, z: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) samples of the components that `choice` (n,) from 0 to 1 picks."""
        weights, means, deviations = parts
        chosen = _pick(weights, choice)
        return _rows(means, chosen) + _rows(deviations, chosen) * z

    def residuals(self, parts: Parts, y: FloatArray, choice: FloatArray) -> FloatArray:
        """(n, d) noise for which `sample` gives the values y (n, d).

        `choice` (n,) draws each row's component by its probability of having produced
        y: with the most probable one, residuals would be too small.
        """
        weights, means, deviations = parts
        z = (y[..., None, :] - means) / deviations
        log = np.log(weights) - (z**2 / 2 + np.log(deviations)).sum(axis=-1)
        posterior = np.exp(log - log.max(axis=-1, keepdims=True))
        posterior /= posterior.sum(axis=-1, keepdims=True)
        return _rows(z, _pick(posterior, choice))


def _pick(weights: FloatArray, choice: FloatArray) -> IntArray:
    """(n,) indices of components, drawn by weights (n, k) with uniform numbers (n,)."""
    passed = np.cumsum(weights, axis=-1) <= choice[:, None]
    return np.asarray(np.minimum(passed.sum(axis=-1), weights.shape[-1] - 1))


def _rows(values: FloatArray, chosen: IntArray) -> FloatArray:
    """(n, d) entries of values (n, k, d), of each row's component `chosen` (n,)."""
    return values[np.arange(len(values)), chosen]
