"""Where a sole touches the ground, and how its four sensors share a force."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from robots.description import Foot
from robots.sole import contact_points, contact_shares, rim_points, sensor_shares

RECTANGLE = np.array([[0.05, 0.03], [0.05, -0.03], [-0.05, 0.03], [-0.05, -0.03]])


def area(corners):
    return ConvexHull(corners).volume


def test_rim_leaves_out_the_flattest_corner():
    outline = np.array([[0, 0], [4, 0], [4, 2], [2, 2.1], [0, 2.0]])
    np.testing.assert_array_equal(rim_points(outline, 4), outline[[0, 1, 2, 4]])
    np.testing.assert_array_equal(rim_points(outline, 5), outline)
    np.testing.assert_array_equal(rim_points(outline, 9), outline)


def test_no_other_single_corner_costs_less():
    angles = np.sort(np.random.default_rng(5).uniform(0, 2 * np.pi, 12))
    outline = np.stack([np.cos(angles), 0.5 * np.sin(angles)], axis=1)
    best = max(area(np.delete(outline, k, axis=0)) for k in range(12))
    assert area(rim_points(outline, 11)) == pytest.approx(best, rel=1e-12)


def test_rim_of_the_nao_keeps_its_area(nao):
    for foot in nao.feet:
        rim = rim_points(foot.outline_m)
        assert len(rim) == 10
        assert 0.975 * area(foot.outline_m) < area(rim) < area(foot.outline_m)


def test_rims_are_mirror_images(nao):
    left, right = (rim_points(foot.outline_m) for foot in nao.feet)
    mirrored = right * [1, -1]
    np.testing.assert_array_equal(
        left[np.lexsort(left.T)], mirrored[np.lexsort(mirrored.T)]
    )


def test_two_contacts_lie_on_the_midline():
    outline = np.array([[0.0, 0], [0.3, 0], [0.3, 0.1], [0, 0.1]])
    foot = Foot(0, -0.05, outline, RECTANGLE)
    points = contact_points(foot)
    assert len(points) == 6
    np.testing.assert_allclose(points[4:], [[0.1, 0.05], [0.2, 0.05]], atol=1e-15)


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((0, 0), (0.25, 0.25, 0.25, 0.25)),
        ((0.05, 0), (0.5, 0.5, 0, 0)),
        ((0, -0.03), (0, 0.5, 0, 0.5)),
        # on a corner: 1/4 + 1/4 + 1/4 there, 1/4 + 1/4 - 1/4 beside it
        ((0.05, 0.03), (0.75, 0.25, 0.25, -0.25)),
        # twice as far ahead as the sensors: the rear ones are pulled
        ((0.1, 0), (0.75, 0.75, -0.25, -0.25)),
    ],
)
def test_shares_by_hand(point, expected):
    (shares,) = sensor_shares(RECTANGLE, np.array([point]))
    np.testing.assert_allclose(shares, expected, atol=1e-12)


@given(
    st.lists(st.floats(-0.1, 0.1), min_size=2, max_size=2),
    st.lists(st.floats(-0.02, 0.02), min_size=8, max_size=8),
)
def test_force_and_moments_balance(point, shifts):
    sensors = RECTANGLE + np.reshape(shifts, (4, 2))
    shares = sensor_shares(sensors, np.array([point]))
    assert shares.sum() == pytest.approx(1.0, abs=1e-9)
    np.testing.assert_allclose(shares @ sensors, [point], atol=1e-9)


def test_a_point_outside_pulls_some_sensor(nao):
    for foot in nao.feet:
        inside = sensor_shares(foot.sensors_m, foot.sensors_m.mean(axis=0)[None])
        assert (inside > 0).all()
        away = [[0.2, 0], [-0.2, 0], [0.02, 0.2], [0.02, -0.2]]
        outside = sensor_shares(foot.sensors_m, np.array(away))
        assert (outside.min(axis=1) < 0).all()
        front, rear, left, right = outside
        assert min(front[:2]) > max(front[2:])
        assert min(rear[2:]) > max(rear[:2])
        assert min(left[[0, 2]]) > max(left[[1, 3]])
        assert min(right[[1, 3]]) > max(right[[0, 2]])


def test_even_pressure_reaches_every_sensor(nao):
    """A force spread over the whole rim presses all four sensors."""
    for foot in nao.feet:
        shares = contact_shares(foot)
        assert shares.shape == (12, 4)
        assert (shares.mean(axis=0) > 0.1).all()
        centre = contact_points(foot).mean(axis=0)
        np.testing.assert_allclose(
            shares.mean(axis=0) @ foot.sensors_m, centre, atol=1e-12
        )


def test_order_of_the_sensors_does_not_matter():
    point = np.array([[0.013, -0.007]])
    shares = sensor_shares(RECTANGLE, point)[0]
    for order in itertools.permutations(range(4)):
        other = sensor_shares(RECTANGLE[list(order)], point)[0]
        np.testing.assert_allclose(other, shares[list(order)], atol=1e-15)
