"""Residuals of parts as if they had not been fitted, against fits without them."""

import numpy as np
import pytest
from scipy.linalg import sqrtm

from diagnosis.residuals.left_out import left_out


def ridge(changes, measured):
    """What the likeliest sizes, of standard deviation 1, leave."""
    powers = changes @ changes.T + np.eye(len(changes))
    return measured - np.linalg.solve(powers, changes @ measured) @ changes


@pytest.mark.parametrize("parts", [2, 5])
def test_a_part_is_predicted_by_the_others_and_whitened_with_their_doubt(parts):
    random = np.random.default_rng(6)
    changes = 3 * random.standard_normal((3, 40))
    measured = random.standard_normal(40) + 2 * changes[0]
    part = np.arange(40) * parts // 40
    found = left_out(ridge(changes, measured), changes, part)
    for number in range(parts):
        own = part == number
        some, rest = changes[:, own], changes[:, ~own]
        spread = np.linalg.inv(rest @ rest.T + np.eye(3))
        wrong = measured[own] - spread @ (rest @ measured[~own]) @ some
        covariance = np.eye(own.sum()) + some.T @ spread @ some
        white = np.linalg.solve(sqrtm(covariance), wrong)
        np.testing.assert_allclose(found[own], white, atol=1e-8)


def drawn(differ, count=400):
    """A residual in two parts, in which 40 values differ or not."""
    random = np.random.default_rng(3)
    changes = random.standard_normal((40, count))
    sizes = random.standard_normal((2, 40))
    part = np.repeat([0, 1], count // 2)
    own = sizes[part if differ else np.zeros(count, int)]
    measured = random.standard_normal(count) + np.sum(own.T * changes, axis=0)
    return ridge(changes, measured), changes, part


def test_many_values_leave_noise_unless_the_parts_differ():
    assert np.mean(left_out(*drawn(False)) ** 2) == pytest.approx(1.0, abs=0.2)
    assert np.mean(left_out(*drawn(True)) ** 2) > 3


def test_a_value_on_a_bound_stays():
    random = np.random.default_rng(1)
    changes, part = random.standard_normal((1, 60)), np.repeat([0, 1], 30)
    held = 5 * changes[0] + random.standard_normal(60)
    np.testing.assert_array_equal(left_out(held, changes, part), held)


def test_what_nothing_was_fitted_to_stays():
    residual = np.arange(6.0)
    found = left_out(residual, np.zeros((0, 6)), np.repeat([0, 1], 3))
    np.testing.assert_array_equal(found, residual)
