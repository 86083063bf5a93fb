"""Scaling: mean 0, variance 1, and columns that never change."""

import numpy as np

from sgat.models.network import Scaling

VALUES = np.random.default_rng(0).normal([5, -3e4, 2e-7], [2, 1e3, 1e-9], (500, 3))


def test_scaled_values_have_mean_0_and_deviation_1():
    scaled = Scaling.of(VALUES).to_scaled(VALUES)
    np.testing.assert_allclose(scaled.mean(axis=0), 0, atol=1e-9)
    np.testing.assert_allclose(scaled.std(axis=0), 1)


def test_there_and_back():
    scaling = Scaling.of(VALUES)
    back = scaling.from_scaled(scaling.to_scaled(VALUES))
    np.testing.assert_allclose(back, VALUES, rtol=1e-12)


def test_a_constant_column_neither_blows_up_nor_varies():
    steady = np.column_stack([VALUES[:, 0], np.full(500, 0.1) + 1e-17, np.zeros(500)])
    scaling = Scaling.of(steady)
    assert scaling.varies.tolist() == [True, False, False]
    new = scaling.to_scaled(np.array([[5.0, 0.6, -2.0]]))
    np.testing.assert_allclose(new[0, 1:], [0.5, -2.0])
    back = scaling.from_scaled(np.full((1, 3), 7.0))
    np.testing.assert_allclose(back[0, 1:], [0.1, 0.0])


def test_rounding_of_a_constant_is_no_spread():
    rounded = 1000 + 1e-13 * np.arange(50.0)[:, None] % 7e-13
    assert np.ptp(rounded) > 0
    assert not Scaling.of(rounded).varies[0]
    assert Scaling.of(1000 + 1e-4 * np.arange(50.0)[:, None]).varies[0]
