"""Corrections of simulated changes, which are kept apart from them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.small_mismatch.fit_point import FitPoint
from diagnosis.residuals.small_mismatch.nuisance import Nuisance

ROWS = 40
RANDOM = np.random.default_rng(0)


@pytest.fixture
def begun():
    """A point with three errors and one value, where changes were simulated."""
    units = tuple(PlacedEffect("payload_mass", name, (0.1,)) for name in "abc")
    changes = RANDOM.standard_normal((3, ROWS))
    errors = Nuisance(
        SimpleNamespace(), units, ((),) * 3, np.zeros(3), Changes.of(changes)
    )
    point = FitPoint.of(errors, np.zeros(1), RANDOM.standard_normal(ROWS))
    return point.simulated(errors, RANDOM.standard_normal((1, ROWS)), np.zeros(1))


def moved(point, step):
    """Another point, with a residual that no linear change explains."""
    sizes = point.errors.sizes + step[:3]
    left = RANDOM.standard_normal(ROWS)
    return replace(
        point, errors=point.errors.at(sizes), x=point.x + step[3:], left=left
    )


def broyden(changes, step, change):
    """The nearest matrix of changes that suits a step, by the formula as it stands."""
    return changes + np.outer(step, change - step @ changes) / (step @ step)


def test_changes_are_corrected_as_by_broyden(begun):
    wanted, point = np.vstack([begun.errors.changes.whole(), begun.slopes]), begun
    for step in RANDOM.standard_normal((3, 4)):
        other = moved(point, step)
        wanted = broyden(wanted, step, other.left - point.left)
        point = point.followed(other)
    np.testing.assert_allclose(point.corrected.changes.whole(), wanted[:3])
    unit = np.array([1.0, 1.0, 1.0, 100.0])[:, None]
    each, left = point.products(100.0)
    np.testing.assert_allclose(each, (unit * wanted) @ (unit * wanted).T)
    np.testing.assert_allclose(left, (unit * wanted) @ point.left)
    assert point.errors.changes is begun.errors.changes  # no copy on the way
    assert point.corrected.changes.seen is begun.errors.changes.seen


def test_what_is_simulated_anew_needs_no_correction(begun):
    point = begun.followed(moved(begun, np.ones(4)))
    fresh = Changes.of(RANDOM.standard_normal((3, ROWS)))
    again = point.simulated(
        replace(point.errors, changes=fresh), begun.slopes, begun.seen_x
    )
    assert again.corrected.changes is fresh
    np.testing.assert_allclose(
        again.products(1.0)[0][:3, :3], fresh.seen @ fresh.seen.T
    )
