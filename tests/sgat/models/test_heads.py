"""Heads against SciPy's and torch's distributions, and against their own samples."""

import numpy as np
import pytest
import torch
from scipy import stats

from sgat.models.heads import (
    LOG_VARIANCE,
    FullHead,
    GaussianHead,
    LowRankHead,
    MixtureHead,
    bounded,
)

D = 3
HEADS = [GaussianHead(D), FullHead(D), LowRankHead(D, 2), MixtureHead(D, 4)]


def raw_of(head, n=5, seed=0):
    return np.random.default_rng(seed).normal(size=(n, head.width))


def variance(raw):
    """The bounded log-variance, from its description alone."""
    return np.exp(-1.5 + 5.5 * np.tanh((raw + 1.5) / 5.5))


def covariance_of(head, parts):
    """(D, D) covariance of the first of some distributions."""
    if isinstance(head, MixtureHead):
        weights, means, deviations = (part[0] for part in parts)
        off = means - weights @ means
        return (weights * off.T) @ off + np.diag(weights @ deviations**2)
    _, factor, *rest = (part[0] for part in parts)
    factor = np.diag(factor) if factor.ndim == 1 else factor
    return factor @ factor.T + (np.diag(rest[0]) if rest else 0.0)


def densities(head, raw, y):
    """(n,) log p(y), assembled with SciPy."""
    rows = []
    for r, point in zip(raw, y, strict=True):
        if isinstance(head, MixtureHead):
            k = head.components
            logits = 8 * np.tanh(r[:k] / 8)
            means = r[k : k + k * D].reshape(k, D)
            spreads = np.sqrt(variance(r[k + k * D :].reshape(k, D)))
            parts = stats.norm(means, spreads).logpdf(point).sum(axis=1)
            weights = np.exp(logits) / np.exp(logits).sum()
            rows.append(np.log((weights * np.exp(parts)).sum()))
            continue
        covariance = np.diag(variance(r[D : 2 * D]))
        if isinstance(head, LowRankHead):
            factor = r[2 * D :].reshape(D, head.rank)
            covariance = factor @ factor.T + covariance
        if isinstance(head, FullHead):
            lower = np.diag(np.sqrt(np.diag(covariance)))
            lower[[1, 2, 2], [0, 0, 1]] = r[2 * D :]
            covariance = lower @ lower.T
        rows.append(stats.multivariate_normal(r[:D], covariance).logpdf(point))
    return np.array(rows)


@pytest.mark.parametrize("head", HEADS)
def test_the_likelihood_is_that_of_scipy(head):
    raw, y = raw_of(head), np.random.default_rng(1).normal(size=(5, D))
    parts = head.parts(torch.tensor(raw), torch)
    for found in (
        head.log_density(parts, torch.tensor(y)),
        -head.loss(parts, torch.tensor(y)),
    ):
        np.testing.assert_allclose(found.numpy(), densities(head, raw, y), rtol=1e-6)


def test_the_papers_loss_is_torchs_own():
    head, y = (
        GaussianHead(D),
        torch.randn(5, D, generator=torch.Generator().manual_seed(2)),
    )
    raw = torch.tensor(raw_of(head), dtype=torch.float32)
    deviation = torch.tensor(np.sqrt(variance(raw[:, D:].numpy())))
    normal = torch.distributions.Normal(raw[:, :D], deviation)
    expected = -torch.distributions.Independent(normal, 1).log_prob(y)
    found = head.loss(head.parts(raw, torch), y)
    torch.testing.assert_close(found, expected)
    assert not torch.allclose(found, 2 * expected)


@pytest.mark.parametrize("head", HEADS)
def test_numpy_and_torch_read_the_same(head):
    raw = raw_of(head)
    for ours, theirs in zip(
        head.parts(raw, np), head.parts(torch.tensor(raw), torch), strict=True
    ):
        np.testing.assert_allclose(ours, theirs.numpy(), rtol=1e-12)


def test_variances_are_softly_bounded():
    raw = np.array([-1e9, -1e3, -1.5, 1e3, 1e9])
    low, high = LOG_VARIANCE
    found = bounded(raw, np)
    np.testing.assert_allclose(found, [low, low, -1.5, high, high])
    slope = (bounded(-1.499, np) - bounded(-1.501, np)) / 0.002
    assert slope == pytest.approx(1, abs=1e-6)
    grid = bounded(np.linspace(-20, 20, 200), np)
    assert (np.diff(grid) > 0).all()


@pytest.mark.parametrize("head", HEADS)
def test_samples_have_the_moments_of_the_distribution(head):
    raw, n = np.repeat(raw_of(head, 1, seed=5), 200_000, axis=0), 200_000
    rng = np.random.default_rng(6)
    parts = head.parts(raw, np)
    drawn = head.sample(parts, rng.normal(size=(n, D)), rng.random(n))
    mean, covariance = head.mean(raw, np)[0], covariance_of(head, parts)
    spread = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(drawn.mean(axis=0), mean, atol=5 * spread.max() / n**0.5)
    np.testing.assert_allclose(
        np.cov(drawn.T), covariance, atol=0.02 * spread.max() ** 2
    )


@pytest.mark.parametrize("head", HEADS)
def test_residuals_undo_samples(head):
    rng, n = np.random.default_rng(7), 50
    raw = raw_of(head, n)
    if isinstance(head, MixtureHead):  # so far apart that it is clear which it was
        raw[:, 4 : 4 + 4 * D] += np.repeat([-900.0, -300.0, 300.0, 900.0], D)
    z, choice = rng.normal(size=(n, D)), rng.random(n)
    parts = head.parts(raw, np)
    y = head.sample(parts, z, choice)
    np.testing.assert_allclose(
        head.residuals(parts, y, rng.random(n)), z, rtol=1e-6, atol=1e-7
    )


def test_a_right_mixture_has_standard_normal_residuals():
    head, n, rng = MixtureHead(1, 2), 50_000, np.random.default_rng(8)
    raw = np.tile([0.0, 0.0, -1.0, 1.0, 0.0, 0.0], (n, 1))  # two that overlap
    parts = head.parts(raw, np)
    y = head.sample(parts, rng.normal(size=(n, 1)), rng.random(n))
    z = head.residuals(parts, y, rng.random(n))
    assert stats.kstest(z[:, 0], "norm").pvalue > 0.001
    always_nearest = np.where(y < 0, y + 1, y - 1) / parts[2][:, 0]
    assert stats.kstest(always_nearest[:, 0], "norm").pvalue < 1e-6


@pytest.mark.parametrize(("beta", "power"), [(0.0, -2), (0.5, -1), (1.0, 0)])
def test_beta_takes_the_variance_out_of_the_means_gradient(beta, power):
    """d loss / d mean = (mean - y) deviation^(2 beta - 2)."""
    head = GaussianHead(1, beta)
    raw = torch.tensor([[0.5, -4.0], [0.5, 2.0]], requires_grad=True)
    y = torch.tensor([[1.5], [1.5]])
    (gradient,) = torch.autograd.grad(head.loss(head.parts(raw, torch), y).sum(), raw)
    deviation = np.sqrt(variance(np.array([-4.0, 2.0])))
    np.testing.assert_allclose(gradient[:, 0], -(deviation**power), rtol=1e-5)
