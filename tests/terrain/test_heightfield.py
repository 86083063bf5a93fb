import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.tri import LinearTriInterpolator, Triangulation

from groundwalk.errors import BadValueError
from terrain import Heightfield


def rough(seed, rows=7, columns=9):
    heights_m = np.random.default_rng(seed).uniform(-0.1, 0.1, (rows, columns))
    return Heightfield(heights_m, (-0.3, 0.2), 0.1)


def test_corners_of_one_cell():
    field = Heightfield(np.array([[1.0, 2.0], [4.0, 8.0]]), (10.0, 20.0), 2.0)
    x_m, y_m = [10.0, 12.0, 10.0, 12.0], [20.0, 20.0, 22.0, 22.0]
    np.testing.assert_array_equal(field.height_at(x_m, y_m), [1.0, 2.0, 4.0, 8.0])


@pytest.mark.parametrize(
    ("u", "v", "height_m"),
    [
        (0.5, 0.5, 4.5),  # on the diagonal from 1 to 8, not 3, the mean of 2 and 4
        (0.75, 0.25, 1.0 * 0.25 + 2.0 * 0.5 + 8.0 * 0.25),  # triangle 1 2 8
        (0.25, 0.75, 1.0 * 0.25 + 4.0 * 0.5 + 8.0 * 0.25),  # triangle 1 4 8
        (0.5, 0.0, 1.5),
        (0.0, 0.5, 2.5),
        (1.0, 0.5, 5.0),
        (0.5, 1.0, 6.0),
    ],
)
def test_both_triangles_of_one_cell(u, v, height_m):
    field = Heightfield(np.array([[1.0, 2.0], [4.0, 8.0]]), (10.0, 20.0), 2.0)
    found = field.height_at(10.0 + 2.0 * u, 20.0 + 2.0 * v)
    assert found == pytest.approx(height_m, abs=1e-12)


@given(seed=st.integers(0, 1000), u=st.floats(0.0, 1.0), v=st.floats(0.0, 1.0))
def test_agrees_with_interpolation_on_the_triangles(seed, u, v):
    field = rough(seed)
    x_m, y_m = -0.3 + 0.8 * u, 0.2 + 0.6 * v
    x_all, y_all, z_all = field.vertices_m.T
    mesh = Triangulation(x_all, y_all, field.triangles)
    expected = LinearTriInterpolator(mesh, z_all)(x_m, y_m)
    if not np.ma.is_masked(expected):  # rounding put the point beside the mesh
        assert field.height_at(x_m, y_m) == pytest.approx(float(expected), abs=1e-9)


def test_triangles_cover_the_ground_once_and_face_up():
    field = rough(0)
    a, b, c = (field.vertices_m[field.triangles[:, k], :2] for k in range(3))
    doubled = np.linalg.det(np.stack([b - a, c - a], axis=-1))
    assert field.triangles.shape == (2 * 6 * 8, 3)
    np.testing.assert_allclose(doubled, 0.1 * 0.1)


def test_ranges_and_vertices_are_in_the_world():
    field = rough(0)
    assert field.x_range_m == pytest.approx((-0.3, 0.5))
    assert field.y_range_m == pytest.approx((0.2, 0.8))
    expected = (-0.3 + 0.1 * 4, 0.2 + 0.1 * 2, field.heights_m[2, 4])
    np.testing.assert_allclose(field.vertices_m[2 * 9 + 4], expected)


def test_outside_is_the_nearest_edge():
    field = rough(1)
    inside = field.height_at([-0.3, 0.5, 0.1], [0.33, 0.8, 0.2])
    outside = field.height_at([-5.0, 0.6, 0.1], [0.33, 9.0, -3.0])
    np.testing.assert_allclose(outside, inside, atol=1e-12)


def test_contains_its_edge_and_nothing_beyond():
    field = rough(1)
    (x_low, x_high), (y_low, y_high) = field.x_range_m, field.y_range_m
    inside = field.contains([x_low, x_high, 0.0], [y_low, y_high, 0.5])
    beyond = field.contains([x_low - 1e-6, 0.0, np.nan], [0.5, y_high + 1e-6, 0.5])
    assert inside.tolist() == [True, True, True]
    assert beyond.tolist() == [False, False, False]


def test_a_lost_robot_has_no_ground_height():
    np.testing.assert_array_equal(
        np.isnan(rough(2).height_at([np.nan, 0.0], [0.3, 0.3])), [True, False]
    )


def test_shapes_broadcast():
    field = rough(3)
    x_m, y_m = np.zeros((1, 5)), np.full((4, 1), 0.5)
    assert field.height_at(x_m, y_m).shape == (4, 5)
    assert field.contains(x_m, y_m).shape == (4, 5)


def test_flat_means_level():
    assert Heightfield(np.full((3, 4), 0.2), (0.0, 0.0), 0.1).is_flat
    assert not rough(0).is_flat


def test_heights_are_locked_and_its_own():
    given_m = np.zeros((2, 2))
    field = Heightfield(given_m, (0.0, 0.0), 0.1)
    given_m[0, 0] = 1.0
    assert field.heights_m[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        field.heights_m[0, 0] = 1.0


@pytest.mark.parametrize(
    ("heights_m", "origin_m", "spacing_m", "message"),
    [
        (np.zeros((1, 4)), (0.0, 0.0), 0.1, "2 x 2"),
        (np.zeros(4), (0.0, 0.0), 0.1, "2 x 2"),
        (np.array([[0.0, np.nan], [0.0, 0.0]]), (0.0, 0.0), 0.1, "finite"),
        (np.array([[0.0, np.inf], [0.0, 0.0]]), (0.0, 0.0), 0.1, "finite"),
        (np.zeros((2, 2)), (0.0, np.nan), 0.1, "origin_m"),
        (np.zeros((2, 2)), (0.0, 0.0), 0.0, "spacing_m"),
        (np.zeros((2, 2)), (0.0, 0.0), np.nan, "spacing_m"),
    ],
)
def test_impossible_heightfields_are_refused(heights_m, origin_m, spacing_m, message):
    with pytest.raises(BadValueError, match=message):
        Heightfield(heights_m, origin_m, spacing_m)
