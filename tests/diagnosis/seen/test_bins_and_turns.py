import numpy as np

from diagnosis.seen.bins import binned, even_edges, quantile_edges
from diagnosis.seen.turns import turns


def test_bins_hold_the_means_of_pieces():
    over = np.tile(np.repeat([0.5, 1.5], 10), 3)
    piece = np.repeat([0, 1, 2], 20)
    values = over + 0.1 * (piece - 1)
    found = binned(over, values, 2 * over, piece, np.array([0.0, 1.0, 2.0]))
    np.testing.assert_allclose(found.at, [0.5, 1.5])
    np.testing.assert_allclose(found.middle, [0.5, 1.5])
    np.testing.assert_allclose(found.high - found.low, 0.16)
    np.testing.assert_allclose(found.law, [1.0, 3.0])


def test_a_bin_of_one_piece_has_no_band_and_is_left_out():
    over = np.concatenate([np.full(20, 0.5), np.full(10, 1.5)])
    piece = np.repeat([0, 1, 0], 10)
    found = binned(over, over, over, piece, np.array([0.0, 1.0, 2.0]))
    np.testing.assert_allclose(found.at, [0.5])
    alone = binned(over, over, over, 0 * piece, np.array([0.0, 1.0, 2.0]))
    assert alone.at.shape == (0,)


def test_edges_rise():
    values = np.concatenate([np.zeros(50), np.arange(50.0)])
    for edges in (quantile_edges(values, 8), even_edges(values, 8)):
        assert (np.diff(edges) > 0).all()
    assert len(quantile_edges(np.zeros(9), 8)) == 1


def test_travel_counts_from_each_turn():
    position = np.array([0, 1, 2, 3, 2, 1, 0, 1, 2.0])
    way, travel = turns(position, 0.5)
    nan = np.nan
    np.testing.assert_array_equal(way, [nan, nan, nan, -1, -1, -1, 1, 1, 1])
    np.testing.assert_array_equal(travel, [nan, nan, nan, 0, 1, 2, 0, 1, 2])


def test_noise_turns_nothing():
    random = np.random.default_rng(0)
    position = np.sin(np.linspace(0, 4 * np.pi, 1000))
    noisy = position + 0.001 * random.standard_normal(1000)
    way, _ = turns(noisy, 0.01)
    assert (np.diff(way[np.isfinite(way)]) != 0).sum() == 3
    assert np.isnan(turns(np.zeros(5), 0.1)[0]).all()
