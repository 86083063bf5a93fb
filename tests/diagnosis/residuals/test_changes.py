"""Corrected changes, against the matrix written out."""

import numpy as np
import pytest

from diagnosis.residuals.changes import Changes


@pytest.fixture
def both():
    """Changes with two corrections, one after the other, and the whole matrix."""
    random = np.random.default_rng(0)
    seen = random.standard_normal((4, 30))
    found, matrix = Changes.of(seen), seen
    for m in (1, 3):
        steps, missed = random.standard_normal((m, 4)), random.standard_normal((m, 30))
        found, matrix = found.corrected(steps, missed), matrix + steps.T @ missed
    assert found.seen is seen
    return found, matrix


def test_all_is_as_of_the_whole_matrix(both):
    found, matrix = both
    assert len(found) == 4
    np.testing.assert_allclose(found.whole(), matrix)
    np.testing.assert_allclose(found.products(), matrix @ matrix.T)
    random = np.random.default_rng(1)
    for shape in ((), (5,)):
        residuals = random.standard_normal((*shape, 30))
        np.testing.assert_allclose(found.on(residuals), residuals @ matrix.T)
        sizes = random.standard_normal((*shape, 4))
        np.testing.assert_allclose(found.by(sizes), sizes @ matrix)


def test_a_part_is_one_of_the_whole_matrix(both):
    found, matrix = both
    part = found.part(slice(5, 12))
    np.testing.assert_allclose(part.whole(), matrix[:, 5:12])
    assert np.shares_memory(part.seen, found.seen)
    own = matrix[:, 5:12]
    np.testing.assert_allclose(part.products(), own @ own.T)
