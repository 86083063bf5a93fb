"""Residuals of parts as if they had not been fitted, against fits without them."""

import numpy as np
import pytest

from diagnosis.residuals.left_out import left_out


def ridge(changes, measured):
    """What the likeliest sizes, of standard deviation 1, leave."""
    powers = changes @ changes.T + np.eye(len(changes))
    return measured - np.linalg.solve(powers, changes @ measured) @ changes


@pytest.mark.parametrize("parts", [2, 5])
def test_a_part_is_predicted_by_the_others(parts):
    random = np.random.default_rng(6)
    changes = 3 * random.standard_normal((3, 40))
    measured = random.standard_normal(40) + 2 * changes[0]
    part = np.arange(40) * parts // 40
    powers = changes @ changes.T + np.eye(3)
    found = left_out(ridge(changes, measured), changes, part)
    for number in range(parts):
        own = part == number
        rest = changes[:, ~own]
        others = rest @ rest.T + np.eye(3)
        sizes = np.linalg.solve(others, rest @ measured[~own])
        np.testing.assert_allclose(found[own], measured[own] - sizes @ changes[:, own])
    fitted = measured - np.linalg.solve(powers, changes @ measured) @ changes
    assert np.sum(found**2) > np.sum(fitted**2)


def test_what_nothing_was_fitted_to_stays():
    residual = np.arange(6.0)
    found = left_out(residual, np.zeros((0, 6)), np.repeat([0, 1], 3))
    np.testing.assert_array_equal(found, residual)
