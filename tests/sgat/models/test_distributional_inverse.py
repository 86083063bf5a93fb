"""The inverse of stochastic sims against linear ones with normal noise."""

import numpy as np
import pytest
from known_dynamics import LIGHT, A, linear, noisy_states, roll

from sgat.models.distributional_inverse import ActionDistribution, DistributionalInverse
from sgat.models.forward_config import ForwardConfig
from sgat.models.inverse_model import InverseModel
from sgat.transitions import Transitions

B = np.array([[0.3, 0.0], [0.1, 0.4]])
OWN = np.array([[0.10, 0.0], [0.05, 0.09]])
"""Square root of the sim's own covariance."""
WANTED = np.array([[0.15, 0.0], [0.05, 0.15]])
"""Square root of the covariance that the next state shall have."""
N = 400
FULL = ForwardConfig(head="full", **LIGHT)


def sim(state, action, rng):
    return state @ A[:2, :2].T + action @ B.T + rng.normal(size=state.shape) @ OWN.T


@pytest.fixture(scope="module")
def data():
    rng = np.random.default_rng(51)
    state, action = rng.normal(size=(5000, 2)), rng.uniform(-1, 1, (5000, 2))
    episode = np.repeat(np.arange(50), 100)
    return Transitions(state, action, sim(state, action, rng), episode)


@pytest.fixture(scope="module")
def model(data):
    return DistributionalInverse(FULL).fit(data, np.random.SeedSequence(52))


@pytest.fixture(scope="module")
def task():
    """States, the policy's actions, and the ideal ones that real makes of them."""
    rng = np.random.default_rng(53)
    state, ideal = rng.normal(size=(N, 2)), rng.uniform(-0.6, 0.6, (N, 2))
    return state, rng.uniform(-0.6, 0.6, (N, 2)), ideal


def wish(task, factor):
    """The real next states: mean and covariance."""
    state, _, ideal = task
    mean = state @ A[:2, :2].T + ideal @ B.T
    return mean, np.broadcast_to(factor @ factor.T, (N, 2, 2))


def test_the_actions_are_those_of_the_closed_form(model, task):
    """a* = B^-1 (m - A s), cov = B^-1 (C - S) B^-T."""
    state, action, ideal = task
    found = model.predict(state, action, *wish(task, WANTED))
    assert np.sqrt(np.mean((found.mean - ideal) ** 2)) < 0.1
    assert np.abs((found.mean - ideal).mean(axis=0)).max() < 0.03
    inverse = np.linalg.inv(B)
    expected = inverse @ (WANTED @ WANTED.T - OWN @ OWN.T) @ inverse.T
    atol = 0.2 * np.abs(expected).max()
    np.testing.assert_allclose(found.covariance.mean(axis=0), expected, atol=atol)


def spread_in_the_sim(state, actions, mean):
    """Covariance of the next states that the sim makes of actions (draws, n, a)."""
    rng = np.random.default_rng(54)
    off = np.array([sim(state, action, rng) - mean for action in actions])
    return np.cov(off.reshape(-1, 2).T)


def test_the_sim_then_does_what_was_wanted(model, task, data):
    state, action, _ = task
    mean, covariance = wish(task, WANTED)
    rng, draws = np.random.default_rng(55), 50
    found = model.predict(state, action, mean, covariance)
    given = [found.sample(rng.normal(size=(N, 2))) for _ in range(draws)]
    wanted = WANTED @ WANTED.T
    atol = 0.15 * np.abs(wanted).max()
    got = spread_in_the_sim(state, given, mean)
    np.testing.assert_allclose(got, wanted, atol=atol)
    # The deterministic sim's way puts the sim's own noise on top.
    plain = InverseModel(FULL).fit(data, np.random.SeedSequence(56))
    samples = [mean + rng.normal(size=(N, 2)) @ WANTED.T for _ in range(draws)]
    given = [plain.predict(state, sample) for sample in samples]
    got = spread_in_the_sim(state, given, mean)
    assert (np.diag(got) - np.diag(wanted)).max() > atol


def test_a_sim_noisier_than_wanted_gets_no_noise_on_top(model, task):
    state, action, ideal = task
    found = model.predict(state, action, *wish(task, 0.3 * OWN))
    size = np.abs(found.covariance).max(axis=(1, 2))
    assert np.median(size) == pytest.approx(0, abs=1e-12)
    assert np.sqrt(np.mean((found.mean - ideal) ** 2)) < 0.1


def test_one_lever_for_many_states():
    """Of what one action cannot do, it does the best; null spaces stay as they were."""
    rng = np.random.default_rng(57)
    b = np.array([[0.0, 0.0], [0.3, 0.0], [0.1, 0.0]])  # the second action does nothing
    state, action = rng.normal(size=(5000, 3)), rng.uniform(-1, 1, (5000, 2))
    after = state + action @ b.T + 0.02 * rng.normal(size=(5000, 3))
    world = Transitions(state, action, after, np.repeat(np.arange(50), 100))
    model = DistributionalInverse(FULL).fit(world, np.random.SeedSequence(58))
    asked = np.column_stack([np.full(100, 0.2), np.linspace(-0.9, 0.9, 100)])
    mean = state[:100] + np.array([0.0, -0.15, -0.05])
    found = model.predict(
        state[:100], asked, mean, np.tile(1e-4 * np.eye(3), (100, 1, 1))
    )
    np.testing.assert_allclose(found.mean[:, 0], -0.5, atol=0.1)
    moved = found.mean[:, 1] - asked[:, 1]
    assert moved.std() < 0.7 * asked[:, 1].std()


def test_a_deterministic_sim_is_inverted_too():
    world = roll(linear, 60, 50, seed=59)
    model = DistributionalInverse(FULL).fit(world, np.random.SeedSequence(60))
    unseen = roll(linear, 4, 50, seed=61)
    small = np.tile(1e-8 * np.eye(3), (unseen.n, 1, 1))
    found = model.predict(unseen.state, 0 * unseen.action, unseen.next_state, small)
    assert np.sqrt(np.mean((found.mean - unseen.action) ** 2)) < 0.1


def test_samples_have_the_moments_of_their_distribution():
    covariance = np.array([[0.5, 0.3], [0.3, 0.18]])  # singular
    n = 100_000
    many = ActionDistribution(
        np.tile([1.0, -2.0], (n, 1)), np.tile(covariance, (n, 1, 1))
    )
    drawn = many.sample(np.random.default_rng(1).normal(size=(n, 2)))
    np.testing.assert_allclose(drawn.mean(axis=0), [1, -2], atol=0.02)
    np.testing.assert_allclose(np.cov(drawn.T), covariance, atol=0.01)


def test_the_score_tells_a_right_model_from_a_wrong_one(model, data):
    other = roll(noisy_states(linear, 0.1 * np.eye(3)), 4, 50, seed=62)
    wrong = Transitions(
        other.state[:, :2], other.action, other.next_state[:, :2], other.episode
    )
    assert model.score(data) > model.score(wrong) + 0.5
