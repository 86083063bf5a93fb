"""Action transformers against the ideal one, which Sim-to-NoisySim tells."""

import numpy as np
import pytest
from conftest import NOISE
from known_dynamics import (
    HIGH,
    LIGHT,
    LOW,
    action_bias,
    seeds,
    spread_ratio,
)

from groundwalk.errors import BadValueError
from sgat.models.config import ForwardConfig, NetworkConfig
from sgat.models.transition_models import ForwardModel, InverseModel
from sgat.noise import ActionNoise, BlockNoise, WhiteNoise
from sgat.transformers.action_transformer import ActionTransformer
from sgat.transitions import Transitions


def transformed(transformer, data):
    transformer.reset(seeds(data.n))
    return transformer(data.state, data.action)


def ideal(data):
    """a + N(0, sigma^2), clipped: what the noisy sim itself does to an action."""
    noise = ActionNoise(NOISE, LOW, HIGH)
    noise.reset(seeds(data.n, root=77))
    return noise(data.state, data.action)


@pytest.fixture(scope="module")
def full(noisy_real):
    config = ForwardConfig(head="full", **LIGHT)
    return ForwardModel(config).fit(noisy_real[0], np.random.SeedSequence(8))


def test_sgat_does_to_actions_what_real_does(full, inverse, noisy_real):
    data = noisy_real[1]
    g = ActionTransformer(full, inverse, LOW, HIGH, WhiteNoise(3))
    found, best = transformed(g, data), ideal(data)
    np.testing.assert_allclose(action_bias(found, best), 0, atol=0.03)
    ratio = spread_ratio(found, best, data.action)
    np.testing.assert_allclose(ratio, 1, atol=0.12)


def test_gat_adds_no_spread(forward, inverse, noisy_real):
    data = noisy_real[1]
    inner = (np.abs(data.action) < 0.5).all(axis=1)  # where clipping has no say
    some = data.subset(inner)
    g = ActionTransformer(forward, inverse, LOW, HIGH)
    found, best = transformed(g, some), ideal(some)
    np.testing.assert_allclose(action_bias(found, best), 0, atol=0.05)
    assert (spread_ratio(found, best, some.action) < 0.25).all()


def one_lever(deviation, seed):
    """One action that moves three states at once, with noise on it."""
    rng = np.random.default_rng(seed)
    state, action = rng.normal(size=(3000, 3)), rng.uniform(-0.5, 0.5, (3000, 1))
    noisy = action + deviation * rng.normal(size=action.shape)
    after = 0.9 * state + noisy @ [[0.2, 0.3, -0.4]]
    return Transitions(state, action, after, np.repeat(np.arange(30), 100))


@pytest.mark.slow
def test_noise_that_no_action_makes_is_lost_on_the_way():
    """The weak point of independent dimensions: the inverse averages their noise."""
    real, sim = one_lever(0.2, seed=83), one_lever(0.0, seed=84)
    inverse = InverseModel(NetworkConfig(**LIGHT)).fit(sim, np.random.SeedSequence(85))
    ratio = {}
    for head in ("gaussian", "full"):
        model = ForwardModel(ForwardConfig(head=head, **LIGHT))
        model.fit(real, np.random.SeedSequence(86))
        g = ActionTransformer(model, inverse, [-2.0], [2.0], WhiteNoise(3))
        added = transformed(g, real) - real.action
        ratio[head] = added.std() / 0.2
    assert ratio["full"] == pytest.approx(1, abs=0.1)
    assert ratio["gaussian"] < 0.8


def test_blocks_of_residuals_fit_in(full, inverse, noisy_real):
    known, data = noisy_real
    law = BlockNoise(full.residuals(known), known.episode, 10)
    g = ActionTransformer(full, inverse, LOW, HIGH, law)
    ratio = spread_ratio(transformed(g, data), ideal(data), data.action)
    np.testing.assert_allclose(ratio, 1, atol=0.15)


def test_actions_stay_within_their_bounds(full, inverse, noisy_real):
    data = noisy_real[1]
    free = ActionTransformer(full, inverse, 9 * LOW, 9 * HIGH, WhiteNoise(3))
    assert np.abs(transformed(free, data)).max() > 1
    tight = ActionTransformer(full, inverse, LOW, 0.5 * HIGH, WhiteNoise(3))
    found = transformed(tight, data)
    assert (found.min(), found.max()) == (-1.0, 0.5)
    np.testing.assert_array_equal(found, np.clip(transformed(free, data), -1, 0.5))


def test_smoothing_mixes_the_actions(full, inverse, noisy_real):
    data = noisy_real[1]
    whole, half, none = (
        transformed(
            ActionTransformer(full, inverse, 9 * LOW, 9 * HIGH, WhiteNoise(3), share),
            data,
        )
        for share in (1.0, 0.5, 0.0)
    )
    np.testing.assert_allclose(half, (whole + data.action) / 2, atol=1e-12)
    np.testing.assert_array_equal(none, data.action)


def test_the_inverse_may_see_less_of_the_state(full, inverse, noisy_real):
    """One more column that only the forward model was fitted to."""
    seen, data = noisy_real
    wide = [
        Transitions(np.hstack([d.state, d.action]), d.action, d.next_state, d.episode)
        for d in (seen, data)
    ]
    config = ForwardConfig(epochs=3)
    model = ForwardModel(config).fit(wide[0], np.random.SeedSequence(87))
    g = ActionTransformer(model, inverse, 9 * LOW, 9 * HIGH, inverse_columns=3)
    expected = inverse.predict(data.state, model.predict(wide[1].state, data.action))
    found = g(wide[1].state, data.action)
    np.testing.assert_allclose(found, np.clip(expected, -9, 9), atol=1e-12)


def test_the_policys_actions_are_left_alone(full, inverse, noisy_real):
    state, action = noisy_real[1].state.copy(), noisy_real[1].action.copy()
    g = ActionTransformer(full, inverse, LOW, HIGH, WhiteNoise(3))
    g.reset(seeds(len(state)))
    g(state, action)
    np.testing.assert_array_equal(state, noisy_real[1].state)
    np.testing.assert_array_equal(action, noisy_real[1].action)


def test_a_reset_starts_the_noise_anew(full, inverse, noisy_real):
    g = ActionTransformer(full, inverse, LOW, HIGH, WhiteNoise(3))
    first, again = transformed(g, noisy_real[1]), transformed(g, noisy_real[1])
    np.testing.assert_array_equal(first, again)
    assert (g(noisy_real[1].state, noisy_real[1].action) != first).any()


def test_a_robot_does_not_depend_on_its_neighbours(full, inverse, noisy_real):
    data = noisy_real[1].subset(noisy_real[1].episode < 2)
    g = ActionTransformer(full, inverse, LOW, HIGH, WhiteNoise(3))
    everyone = transformed(g, data)
    g.reset(seeds(data.n)[7:9])
    found = g(data.state[7:9], data.action[7:9])
    np.testing.assert_allclose(found, everyone[7:9], atol=1e-5)


def test_what_does_not_fit_is_refused(full, inverse):
    with pytest.raises(BadValueError, match="smoothing"):
        ActionTransformer(full, inverse, LOW, HIGH, smoothing=1.5)
    with pytest.raises(BadValueError, match="2 dimensions; it must have 3"):
        ActionTransformer(full, inverse, LOW, HIGH, WhiteNoise(2))
    g = ActionTransformer(full, inverse, LOW, HIGH, WhiteNoise(3))
    with pytest.raises(BadValueError, match="reset with 2 seeds"):
        g(np.ones((2, 3)), np.ones((2, 2)))
    g.reset(seeds(3))
    with pytest.raises(BadValueError, match="reset with 2 seeds"):
        g(np.ones((2, 3)), np.ones((2, 2)))


# Noise on actions


def test_action_noise_has_its_deviation_and_is_clipped():
    noise = ActionNoise(0.2, LOW, HIGH)
    noise.reset(seeds(5000))
    action = np.tile([0.0, 0.9], (5000, 1))
    noisy = np.array([noise(np.empty((5000, 0)), action) for _ in range(20)])
    assert noisy[..., 0].std() == pytest.approx(0.2, rel=0.02)
    assert noisy[..., 0].mean() == pytest.approx(0, abs=0.004)
    assert noisy.max() == 1
    assert np.mean(noisy[..., 1] == 1) == pytest.approx(0.3085, abs=0.01)  # P(z > 0.5)
    assert (action == [0.0, 0.9]).all()


def test_action_noise_is_the_seeds():
    noise, action = ActionNoise(0.2, LOW, HIGH), np.zeros((3, 2))
    runs = []
    for root in (1, 1, 2):
        noise.reset(seeds(3, root))
        runs.append(noise(action, action))
    np.testing.assert_array_equal(runs[0], runs[1])
    assert (runs[0] != runs[2]).all()


def test_action_noise_without_seeds_is_refused():
    with pytest.raises(BadValueError, match="deviation"):
        ActionNoise(-0.1, LOW, HIGH)
    with pytest.raises(BadValueError, match="reset with 3 seeds"):
        ActionNoise(0.1, LOW, HIGH)(np.ones((3, 2)), np.ones((3, 2)))
