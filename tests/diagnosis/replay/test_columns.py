"""Columns as slices, where they are."""

import numpy as np
import pytest

from diagnosis.replay.columns import columns


@pytest.mark.parametrize(
    ("numbers", "is_view"),
    [([0, 1, 2], True), ([3], True), ([7, 8], True), ([1, 0], False), ([0, 2], False)],
)
def test_neighbours_are_seen_without_a_copy(numbers, is_view):
    values = np.arange(20.0).reshape(2, 10)
    found = values[:, columns(numbers)]
    np.testing.assert_array_equal(found, values[:, np.array(numbers)])
    assert np.shares_memory(found, values) is is_view
