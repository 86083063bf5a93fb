"""The inverse model: inverse after forward is the action."""

import numpy as np
import pytest
from known_dynamics import HIGH, LOW, bent, linear, noisy_actions, roll

from groundwalk.errors import BadValueError
from sgat.models.config import NetworkConfig
from sgat.models.transition_models import InverseModel


@pytest.mark.parametrize(
    ("world", "name", "error"),
    [(linear, "inverse", 0.02), (bent, "bent_inverse", 0.06)],
)
def test_inverse_after_forward_is_the_action(world, name, error, request):
    model = request.getfixturevalue(name)
    unseen = roll(world, 20, 50, seed=41)
    found = model.predict(unseen.state, unseen.next_state)
    assert np.sqrt(np.mean((found - unseen.action) ** 2)) < error
    assert (model.score(unseen) > 0.985).all()


def test_the_wrong_worlds_inverse_is_not_the_action(inverse):
    unseen = roll(bent, 20, 50, seed=41)
    assert (inverse.score(unseen) < 0.97).all()


def test_the_score_is_each_actions_share_of_variance(inverse):
    """Noise of variance v on actions of variance 1/3 leaves 1 / (1 + 3 v)."""
    n = 20_000
    rng = np.random.default_rng(1)
    state, action = rng.normal(size=(n, 3)), rng.uniform(LOW, HIGH, (n, 2))
    seen = roll(linear, 2, 2, seed=1)
    given = action + rng.normal(size=(n, 2)) * [0.0, 0.5]
    after = linear(state, action)
    two = type(seen)(state, given, after, np.repeat([0, 1], n // 2))
    np.testing.assert_allclose(inverse.score(two), [1, 4 / 7], atol=0.01)


def test_a_noisy_sim_makes_least_squares_shrink(inverse):
    """What this model is not for."""
    step = noisy_actions(linear, 0.6)
    noisy = roll(step, 60, 50, seed=42)
    shrunk = InverseModel().fit(noisy, np.random.SeedSequence(2))
    unseen = roll(linear, 20, 50, seed=43)
    found = shrunk.predict(unseen.state, unseen.next_state).std(axis=0)
    assert (found < 0.9 * unseen.action.std(axis=0)).all()


def test_an_action_that_was_never_varied_is_its_constant():
    seen = roll(linear, 10, 20, seed=44)
    steady = np.column_stack([seen.action[:, 0], np.full(seen.n, 0.7)])
    world = type(seen)(seen.state, steady, seen.next_state, seen.episode)
    model = InverseModel(NetworkConfig(epochs=2)).fit(world, np.random.SeedSequence(1))
    found = model.predict(seen.state, seen.next_state)
    np.testing.assert_array_equal(found[:, 1], 0.7)
    assert np.isnan(model.score(world)[1])


def test_the_same_seed_gives_the_same_bits():
    seen = roll(linear, 10, 20, seed=45)
    config = NetworkConfig(epochs=3)
    one, again, other = (
        InverseModel(config).fit(seen, np.random.SeedSequence(seed))
        for seed in (1, 1, 2)
    )
    found = [m.predict(seen.state, seen.next_state) for m in (one, again, other)]
    np.testing.assert_array_equal(found[0], found[1])
    assert (found[0] != found[2]).any()


def test_before_fitting_there_is_nothing_to_predict():
    with pytest.raises(BadValueError, match="has not been fitted"):
        InverseModel().predict(np.ones((1, 3)), np.ones((1, 3)))
