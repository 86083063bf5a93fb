"""Likely sizes of small errors against closed forms."""

import numpy as np
import pytest
from scipy.optimize import minimize

from diagnosis.residuals.changes import Changes
from diagnosis.residuals.small_mismatch.likely_sizes import gain_of, likeliest

ALL = np.ones(2, bool)


def likely(changes, left, *known, **options):
    """Sizes that are likely, by what each would change of a residual."""
    return likeliest(changes @ changes.T, changes @ left, *known, **options)


def test_sizes_are_drawn_to_zero_as_by_a_ridge():
    changes = np.array([[3.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    left = -np.array([6.0, 2.0, 5.0])  # sizes of 2 explain it but for the last entry
    ends = np.full(2, -9.0), np.full(2, 9.0)
    found = likely(changes, left, np.zeros(2), ALL, *ends)
    assert found == pytest.approx([2 * 9 / 10, 2 * 1 / 2])
    # the same from a residual that has some of them
    begun = np.array([1.0, -1.0])
    found = likely(changes, left + begun @ changes, begun, ALL, *ends)
    assert found == pytest.approx([1.8, 1.0])


def test_bounds_hold_and_the_others_take_over():
    changes = np.array([[1.0, 0.0], [1.0, 0.1]])
    left = -np.array([10.0, 0.0])
    low, high = np.zeros(2), np.array([2.0, 9.0])
    found = likely(changes, left, np.zeros(2), ALL, low, high)
    rest = minimize(lambda x: (8 - x) ** 2 + (0.1 * x) ** 2 + x**2, 1.0, method="BFGS")
    assert found == pytest.approx([2.0, rest.x[0]], abs=1e-4)
    only = likely(changes, left, np.zeros(2), np.array([True, False]), low, high)
    assert only == pytest.approx([2.0, 0.0], abs=1e-6)


def test_damping_holds_sizes_back_by_how_much_they_change():
    """A size is least for the squares left, its own and those of its step together.

    What changes three times as much has nine times the weight in both.
    """
    changes = np.array([[3.0, 0.0], [0.0, 1.0]])
    left = -np.array([6.0, 2.0])
    ends = np.full(2, -9.0), np.full(2, 9.0)
    found = likely(changes, left, np.zeros(2), ALL, *ends, damping=2.0)
    assert found == pytest.approx([2 * 9 / (10 + 18), 2 * 1 / (2 + 2)])
    begun = np.array([1.0, 4.0])
    left = left + begun @ changes
    found = likely(changes, left, begun, ALL, *ends, damping=1e6)
    assert found == pytest.approx(begun, abs=1e-4)


def test_products_so_large_that_they_are_rounded():
    """Errors that change the same, 1e8 noise each: rounding outdoes what holds them."""
    rng = np.random.default_rng(1)
    same = 1e8 * rng.standard_normal(50)
    changes = np.stack([same, 1.1 * same, 1.3 * same, 1e8 * rng.standard_normal(50)])
    left = -(2 * same + 3 * changes[3])
    known = np.zeros(4), np.ones(4, bool), np.full(4, -9.0), np.full(4, 9.0)
    with pytest.raises(np.linalg.LinAlgError):
        np.linalg.cholesky(changes @ changes.T + np.eye(4))
    found = likely(changes, left, *known)
    assert found @ [1.0, 1.1, 1.3, 0.0] == pytest.approx(2.0, rel=1e-4)
    assert found[3] == pytest.approx(3.0, rel=1e-4)


def test_a_gain_is_the_energy_that_falls():
    rng = np.random.default_rng(3)
    changes, sizes = rng.standard_normal((3, 40)), np.array([3.0, 0.5, 1.0])
    left = rng.standard_normal(40) - 4 * changes[0]
    fixed = np.array([True, False, True])

    def energy(x):
        other = np.array([x[0], x[1], 1.0])
        rest = left + (other - sizes) @ changes
        return 0.5 * (rest @ rest + other[1] ** 2)

    least = minimize(energy, [3.0, 0.5], method="BFGS").fun
    gain = gain_of(Changes.of(changes), left, sizes, [0], fixed)
    assert gain == pytest.approx(energy([3.0, 0.5]) - least, rel=1e-4)
