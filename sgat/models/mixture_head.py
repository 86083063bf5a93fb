"""Head for a mixture of normal distributions: dynamics with more than one outcome."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import torch.distributions as td
from torch import Tensor

from groundwalk.arrays import FloatArray, IntArray
from sgat.models.heads import Head, Parts, bounded

_LARGEST_LOGIT = 8.0
"""Bound of a component's logit: weights differ by a factor of at most e^16, so that
training can bring back a component that has hardly any weight."""


@dataclass(frozen=True)
class MixtureHead(Head):
    """Mixture of normal distributions with independent dimensions (Bishop 1994).

    Attributes:
      components: k, the number of normal distributions.
    """

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

        The component of each row is drawn, with `choice` (n,), by its probability of
        having produced y. With the most probable one instead, the residuals of
        overlapping components would be too small.
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
