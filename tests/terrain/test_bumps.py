import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import terrain

START = {"start_radius_m": 0.0, "blend_m": 0.01}


@settings(max_examples=30)
@given(
    seed=st.integers(0, 2**64),
    height_m=st.floats(0.001, 0.1),
    radius_m=st.floats(0.05, 0.4),
    density_per_m2=st.floats(1.0, 100.0),
)
def test_heights_stay_within_bounds_and_no_flank_is_steeper_than_the_profile(
    seed, height_m, radius_m, density_per_m2
):
    field = terrain.make(
        "bumps",
        seed,
        height_m=height_m,
        radius_m=radius_m,
        density_per_m2=density_per_m2,
        x_range_m=(-1.0, 2.0),
    )
    assert field.heights_m.min() >= 0.0
    assert field.heights_m.max() <= height_m
    # h (1 - s^2)^2 is steepest at s = 1 / sqrt(3); blending adds 1.5 / 0.25 h.
    flank = height_m * (8.0 / (3.0 * math.sqrt(3.0)) / radius_m + 1.5 / 0.25)
    for axis in (0, 1):
        steepest = np.abs(np.diff(field.heights_m, axis=axis)).max() / 0.025
        assert steepest <= flank + 1e-9


@pytest.mark.parametrize(("density_per_m2", "radius_m"), [(10.0, 0.1), (40.0, 0.08)])
def test_they_cover_the_share_that_a_poisson_process_covers(density_per_m2, radius_m):
    field = terrain.make(
        "bumps",
        1,
        radius_m=radius_m,
        density_per_m2=density_per_m2,
        x_range_m=(-8.0, 8.0),
        y_range_m=(-8.0, 8.0),
        **START,
    )
    inside = field.heights_m[10:-10, 10:-10]  # no bump has its centre off the ground
    covered = 1.0 - math.exp(-density_per_m2 * math.pi * radius_m**2)
    assert np.mean(inside > 0.0) == pytest.approx(covered, abs=0.02)


def test_a_lone_bump_is_round_with_the_stated_profile():
    # Seed 6 draws one bump, all of it on the ground.
    field = terrain.make(
        "bumps", 6, radius_m=0.5, height_m=0.1, density_per_m2=0.05, **START
    )
    bump = field.heights_m > 1e-9
    x_m, y_m, z_m = field.vertices_m[bump.ravel()].T
    # sqrt(z) = sqrt(h) (1 - r^2 / R^2) is a quadric: fit and read off R and h.
    terms = np.stack([x_m**2, y_m**2, x_m * y_m, x_m, y_m, np.ones_like(x_m)], axis=1)
    fit, residual, *_ = np.linalg.lstsq(terms, np.sqrt(z_m))
    bend, _, cross, along_x, along_y, constant = fit
    root_height = constant - (along_x**2 + along_y**2) / (4.0 * bend)
    assert residual[0] < 1e-18
    assert fit[1] == pytest.approx(bend)
    assert cross == pytest.approx(0.0, abs=1e-9)
    assert math.sqrt(-root_height / bend) == pytest.approx(0.5)
    assert bump.sum() * 0.025**2 == pytest.approx(math.pi * 0.5**2, rel=0.01)
    assert z_m.max() <= root_height**2 <= 0.1


def test_heights_of_bumps_are_spread_evenly():
    field = terrain.make(
        "bumps", 2, x_range_m=(-8, 8), y_range_m=(-8, 8), density_per_m2=4.0, **START
    )
    middle = field.heights_m[1:-1, 1:-1]
    around = [
        field.heights_m[1 + i : 640 + i, 1 + j : 640 + j]
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
    ]
    tops_m = middle[(middle > 1e-4) & (middle == np.max(around, axis=0))]
    quartiles = np.percentile(tops_m, [25, 50, 75]) / 0.015
    assert 700 < tops_m.size < 1030  # of about 16 * 16 * 4 = 1024, less the overlaps
    np.testing.assert_allclose(quartiles, [0.25, 0.5, 0.75], atol=0.06)


def test_no_bumps_is_flat_ground():
    assert terrain.make("bumps", 4, density_per_m2=0.0).is_flat
    assert terrain.make("bumps", 4, height_m=0.0).is_flat
