"""The forward model against worlds of which everything is known."""

import numpy as np
import pytest
from known_dynamics import LIGHT, linear, noisy_actions, noisy_states, roll, seeds
from scipy import stats

from groundwalk.errors import BadValueError, UnknownNameError
from sgat.models.config import ForwardConfig
from sgat.models.transition_models import ForwardModel
from sgat.noise import NoiseStream, WhiteNoise
from sgat.transitions import Transitions

SEED = np.random.SeedSequence(11)
SPREAD = np.array([[0.03, 0, 0], [0.05, 0.02, 0], [-0.02, 0.03, 0.04]])


@pytest.fixture(scope="module")
def scattered():
    """(fitted to, held out) of the linear world plus correlated noise."""
    step = noisy_states(linear, SPREAD)
    return roll(step, 60, 50, seed=21), roll(step, 60, 50, seed=22)


@pytest.fixture(scope="module")
def gaussian(scattered):
    return ForwardModel(ForwardConfig(**LIGHT)).fit(scattered[0], SEED)


@pytest.fixture(scope="module")
def full(scattered):
    return ForwardModel(ForwardConfig(head="full", **LIGHT)).fit(scattered[0], SEED)


def quick(**options):
    return ForwardConfig(hidden=(16,), epochs=5, **options)


def test_the_mean_is_the_worlds(gaussian, scattered):
    held_out = scattered[1]
    wrong = gaussian.predict(held_out.state, held_out.action) - linear(
        held_out.state, held_out.action
    )
    assert (np.sqrt((wrong**2).mean(axis=0)) < 0.15 * held_out.change.std(axis=0)).all()


def deviations(model, data):
    """(n, p) standard deviations of the predicted normal distributions."""
    off = data.next_state - model.predict(data.state, data.action)
    return off / model.residuals(data)


def test_the_spread_is_the_worlds(gaussian, scattered):
    variance = (deviations(gaussian, scattered[1]) ** 2).mean(axis=0)
    np.testing.assert_allclose(variance, np.diag(SPREAD @ SPREAD.T), rtol=0.15)


def test_a_full_covariance_is_the_worlds(full):
    n = 20_000
    state, action = np.full((n, 3), 0.3), np.full((n, 2), -0.2)
    stream = NoiseStream(WhiteNoise(3), [np.random.SeedSequence(i) for i in range(n)])
    drawn = full.sample(state, action, stream)
    assert drawn.dtype == np.float64
    mean = full.predict(state[:1], action[:1])[0]
    np.testing.assert_allclose(drawn.mean(axis=0), mean, atol=2e-3)
    expected = SPREAD @ SPREAD.T
    largest = np.abs(expected).max()
    np.testing.assert_allclose(np.cov(drawn.T), expected, atol=0.2 * largest)


def test_residuals_are_standardised(gaussian, full, scattered):
    residuals = gaussian.residuals(scattered[1])
    np.testing.assert_allclose(residuals.std(axis=0), 1, atol=0.1)
    np.testing.assert_allclose(residuals.mean(axis=0), 0, atol=0.2)
    assert np.corrcoef(residuals.T)[0, 1] > 0.8  # 0.93 in the world
    assert np.abs(np.corrcoef(full.residuals(scattered[1]).T)[0, 1]) < 0.2


def test_the_score_is_the_likelihood_in_the_states_units(gaussian, full, scattered):
    held_out = scattered[1]
    mean = gaussian.predict(held_out.state, held_out.action)
    deviation = deviations(gaussian, held_out)
    expected = stats.norm(mean, deviation).logpdf(held_out.next_state).mean()
    assert gaussian.score(held_out) == pytest.approx(expected, rel=1e-4)
    true = stats.multivariate_normal(cov=SPREAD @ SPREAD.T)
    best = true.logpdf(held_out.next_state - linear(held_out.state, held_out.action))
    assert gaussian.score(held_out) + 0.2 < full.score(held_out)
    assert best.mean() / 3 - 0.1 < full.score(held_out) <= best.mean() / 3


def test_two_outcomes_take_a_mixture():
    """s' - s is +1 or -1: a normal distribution can only be wide."""
    rng = np.random.default_rng(1)
    state = rng.normal(size=(2000, 1))
    jump = rng.choice([-1.0, 1.0], (2000, 1)) + rng.normal(0, 0.1, (2000, 1))
    episode = np.repeat(np.arange(20), 100)
    world = Transitions(state, rng.normal(size=(2000, 1)), state + jump, episode)
    wide = stats.norm(0, np.sqrt(1.01)).logpdf(jump).mean()

    def fitted(config):
        model = ForwardModel(config).fit(world, SEED)
        stream = NoiseStream(WhiteNoise(1), seeds(2000))
        moved = np.abs(model.sample(state, world.action, stream) - state)
        return model.score(world), np.mean(np.abs(moved - 1) < 0.3)

    score, right = fitted(ForwardConfig(head="mixture", components=2, **LIGHT))
    assert score > wide + 0.5
    assert right > 0.95
    score, right = fitted(ForwardConfig(beta=0.5, **LIGHT))
    assert score == pytest.approx(wide, abs=0.05)
    assert right < 0.5


def test_low_rank_covariance_fits_better_than_none(scattered, gaussian):
    config = ForwardConfig(head="low-rank", rank=1, **LIGHT)
    model = ForwardModel(config).fit(scattered[0], SEED)
    assert model.score(scattered[1]) > gaussian.score(scattered[1]) + 0.1


def test_what_never_changes_is_never_disturbed():
    world = roll(noisy_actions(linear, 0.3), 10, 20, seed=31)
    constant = np.full((world.n, 1), 4.0)
    state = np.hstack([world.state, constant])
    after = np.hstack([world.next_state, constant])
    steady = Transitions(state, world.action, after, world.episode)
    model = ForwardModel(quick()).fit(steady, SEED)
    stream = NoiseStream(WhiteNoise(4), seeds(world.n))
    drawn = model.sample(state, world.action, stream)
    np.testing.assert_array_equal(drawn[:, 3], 4.0)
    assert (drawn[:, 2] != after[:, 2]).all()


def test_context_is_looked_at_but_not_predicted():
    """What comes next depends on a column that the next state does not have."""
    rng = np.random.default_rng(2)
    state, action = rng.normal(size=(1500, 2)), rng.normal(size=(1500, 1))
    after = state[:, :1] + 0.5 * state[:, 1:] + 0.1 * action
    world = Transitions(state, action, after, np.repeat(np.arange(15), 100))
    model = ForwardModel(ForwardConfig(**LIGHT)).fit(world, SEED)
    assert model.outcomes == 1
    assert np.std(model.predict(state, action) - after) < 0.05
    blind = Transitions(state[:, :1], action, after, world.episode)
    wrong = ForwardModel(quick()).fit(blind, SEED).predict(state[:, :1], action) - after
    assert wrong.std() > 0.4


class Silence:
    """No noise at all."""

    dimensions = 3

    def chunk(self, generators):
        return np.zeros((8, len(generators), 3))


def test_a_robot_keeps_its_member_for_an_episode(scattered):
    model = ForwardModel(quick(members=4)).fit(scattered[0], SEED)
    state, action = np.zeros((60, 3)), np.full((60, 2), 0.5)
    stream = NoiseStream(Silence(), seeds(60))
    ticks = np.array([model.sample(state, action, stream) for _ in range(10)])
    np.testing.assert_array_equal(ticks, ticks[:1].repeat(10, axis=0))
    answers = np.unique(ticks[0], axis=0)
    assert len(answers) == 4
    np.testing.assert_allclose(
        model.predict(state[:1], action[:1])[0], answers.mean(axis=0), atol=1e-6
    )
    again = NoiseStream(Silence(), seeds(60, root=6))
    assert (model.sample(state, action, again) != ticks[0]).any()


def test_each_episodes_residuals_are_one_members(scattered):
    model = ForwardModel(quick(members=2)).fit(scattered[0], SEED)
    four = scattered[1].subset(scattered[1].episode < 4)
    odd = model.residuals(four.subset(four.episode % 2 == 1))
    mixed = model.residuals(four)[four.episode % 2 == 1]
    assert np.abs(odd - mixed)[:50].max() > 1e-3  # alone, episode 1 has member 0
    np.testing.assert_allclose(odd[50:], mixed[50:], atol=1e-5)


def test_the_same_seed_gives_the_same_bits(scattered):
    seed = np.random.SeedSequence(3)
    config, state, action = quick(members=2), np.ones((4, 3)), np.ones((4, 2))
    one, again, other = (
        ForwardModel(config).fit(scattered[0], s).predict(state, action)
        for s in (seed, seed, np.random.SeedSequence(4))
    )
    np.testing.assert_array_equal(one, again)
    assert (one != other).all()
    assert seed.n_children_spawned == 0


def test_before_fitting_there_is_nothing_to_predict():
    with pytest.raises(BadValueError, match="has not been fitted"):
        ForwardModel().predict(np.ones((1, 3)), np.ones((1, 2)))


def test_a_state_of_another_width_is_refused(gaussian):
    with pytest.raises(BadValueError, match="5 inputs"):
        gaussian.predict(np.ones((1, 4)), np.ones((1, 2)))


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"head": "gausian"}, UnknownNameError),
        ({"components": 0}, BadValueError),
        ({"rank": 0}, BadValueError),
        ({"members": 0}, BadValueError),
        ({"beta": 1.5}, BadValueError),
        ({"beta": 0.5, "head": "full"}, BadValueError),
        ({"epochs": 0}, BadValueError),
    ],
)
def test_what_is_no_distribution_is_refused(options, error):
    with pytest.raises(error):
        ForwardConfig(**options)
