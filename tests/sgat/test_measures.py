"""Measures: what is good is called good, what is not is not."""

import dataclasses
import json
from statistics import NormalDist

import numpy as np
import pytest
from known_dynamics import A, B, linear, noisy_states, roll

from groundwalk.errors import BadValueError
from sgat import measures
from sgat.grounding_report import HORIZON, LEVELS, grounding_report
from sgat.transitions import Transitions

N = 40_000
RNG = np.random.default_rng(0)
WHITE = RNG.standard_normal((N, 2))
EPISODE = np.repeat(np.arange(N // 200), 200)


def autoregressive(p):
    values = WHITE.copy()
    for t in range(1, N):
        values[t] = p * values[t - 1] + np.sqrt(1 - p**2) * values[t]
    return values


def test_root_mean_square():
    found = measures.root_mean_square(np.array([[3.0, -1.0], [-4.0, 1.0]]))
    np.testing.assert_allclose(found, [np.sqrt(12.5), 1.0])


def test_r_squared_of_the_best_the_mean_and_worse():
    actual = WHITE + 5
    mean = np.tile(actual.mean(axis=0), (N, 1))
    for predicted, expected in (
        (actual, 1),
        (mean, 0),
        (actual + 2 * actual.std(axis=0), -3),
    ):
        np.testing.assert_allclose(
            measures.r_squared(predicted, actual), expected, atol=1e-9
        )
    assert np.isnan(measures.r_squared(np.zeros((3, 1)), np.ones((3, 1)))[0])


def test_errors_of_many_steps_add_up():
    """A model that is off by d in each step of s' = A s + B a: sum of A^k d."""
    data, d = roll(linear, 5, 20, seed=1), np.array([0.01, 0.02, -0.01])
    exact = measures.multi_step_error(linear, data, 6)
    np.testing.assert_allclose(exact, 0, atol=1e-12)
    off = measures.multi_step_error(lambda s, a: linear(s, a) + d, data, 6)
    sums = np.cumsum([np.linalg.matrix_power(A, k) @ d for k in range(6)], axis=0)
    np.testing.assert_allclose(off, np.abs(sums), rtol=1e-9)


def test_errors_of_many_steps_end_with_the_episode():
    data = roll(linear, 5, 7, seed=2)
    assert measures.multi_step_error(linear, data, 7).max() < 1e-12
    with pytest.raises(BadValueError, match="8 ticks"):
        measures.multi_step_error(linear, data, 8)


def test_only_what_is_predicted_has_an_error():
    data = roll(linear, 5, 9, seed=3)
    narrow = Transitions(data.state, data.action, data.next_state[:, :1], data.episode)
    assert measures.multi_step_error(linear, narrow, 4).shape == (4, 1)


@pytest.mark.parametrize("spread", [0.5, 1.0, 2.0])
def test_coverage_tells_calibrated_from_over_and_under_confident(spread):
    levels = (0.5, 0.9)
    found = measures.coverage(spread * WHITE, levels)
    for row, level in zip(found, levels, strict=True):
        bound = NormalDist().inv_cdf((1 + level) / 2) / spread
        expected = 2 * NormalDist().cdf(bound) - 1
        np.testing.assert_allclose(row, expected, atol=0.01)
    assert np.allclose(found[1], 0.9, atol=0.01) == (spread == 1.0)


@pytest.mark.parametrize("p", [0.0, 0.6, -0.3])
def test_autocorrelation_tells_white_from_coloured(p):
    found = measures.autocorrelation(autoregressive(p), EPISODE, 3)
    expected = np.array([p, p**2, p**3])[:, None].repeat(2, axis=1)
    np.testing.assert_allclose(found, expected, atol=0.03)
    assert (np.abs(found[0]) < 0.03).all() == (p == 0.0)


def test_autocorrelation_does_not_look_across_episodes():
    pairs = np.repeat(RNG.standard_normal(5000), 2)[:, None]
    found = measures.autocorrelation(pairs, np.arange(10_000) // 2, 1)
    np.testing.assert_allclose(found, 1, atol=1e-9)
    across = measures.autocorrelation(pairs, np.zeros(10_000, int), 1)
    np.testing.assert_allclose(across, 0.5, atol=0.03)
    with pytest.raises(BadValueError, match="longer than 2"):
        measures.autocorrelation(pairs, np.arange(10_000) // 2, 2)


def test_cross_correlation():
    mixed = WHITE @ np.array([[1.0, 0.8], [0.0, 0.6]]) * [3.0, 0.1] + 2
    np.testing.assert_allclose(
        measures.cross_correlation(mixed), [[1, 0.8], [0.8, 1]], atol=0.02
    )
    np.testing.assert_allclose(measures.cross_correlation(WHITE), np.eye(2), atol=0.02)


def test_kurtosis_tells_normal_from_heavy_and_thin_tails():
    """0; 6 / (8 - 4) of Student's t with 8 degrees; -1.2 of a uniform one."""
    for values, expected, atol in (
        (7 * WHITE + 3, 0, 0.1),
        (RNG.standard_t(8, (400_000, 2)), 1.5, 0.4),
        (RNG.uniform(size=(N, 2)), -1.2, 0.05),
    ):
        np.testing.assert_allclose(
            measures.excess_kurtosis(values), expected, atol=atol
        )


def test_constants_have_neither_correlation_nor_kurtosis():
    flat = np.column_stack([WHITE[:, 0], np.full(N, 0.1)])
    assert np.isnan(measures.excess_kurtosis(flat)).tolist() == [False, True]
    assert np.isnan(measures.autocorrelation(flat, EPISODE, 1)).tolist() == [
        [False, True]
    ]
    assert np.isnan(measures.cross_correlation(flat)).sum() == 3


# The report


def arrays(report):
    return {name: np.array(value) for name, value in report.items()}


@pytest.fixture(scope="module")
def report(forward, noisy_real):
    return arrays(grounding_report(forward, noisy_real[1], forward.predict))


def test_a_good_model_gets_a_good_report(report, forward, noisy_real):
    assert (report["one_step_r_squared"] > 0.5).all()
    assert report["log_likelihood"] == forward.score(noisy_real[1])
    np.testing.assert_allclose(
        report["coverage"], np.array(LEVELS)[:, None].repeat(3, axis=1), atol=0.05
    )
    assert np.abs(report["autocorrelation"]).max() < 0.1
    assert report["multi_step_error"].shape == (HORIZON, 3)
    np.testing.assert_allclose(
        report["multi_step_error"][0], report["one_step_error"], rtol=0.1
    )
    assert (report["multi_step_error"][-1] > report["multi_step_error"][0]).all()
    across = B @ B.T  # of noise on both actions
    across /= np.sqrt(np.outer(np.diag(across), np.diag(across)))
    np.testing.assert_allclose(report["cross_correlation"], across, atol=0.1)


def test_a_bad_model_gets_a_bad_report(report, forward):
    other = roll(noisy_states(linear, 0.3 * np.eye(3)), 20, 50, seed=9)
    bad = arrays(grounding_report(forward, other, forward.predict))
    assert (bad["coverage"][2] < 0.6).all()
    assert bad["log_likelihood"] < report["log_likelihood"] - 1
    assert (bad["one_step_error"] > report["one_step_error"]).all()


def test_a_report_is_plain_json(forward, noisy_real):
    still = np.array(noisy_real[1].next_state)
    still[:, 0] = noisy_real[1].state[:, 0]
    world = dataclasses.replace(noisy_real[1], next_state=still)
    plain = grounding_report(forward, world, forward.predict)
    assert plain == json.loads(json.dumps(plain, allow_nan=False))
    assert plain["one_step_r_squared"][0] is None
