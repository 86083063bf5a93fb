import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import robots
from robots.description import Capsule, Foot
from terrain import Heightfield
from worlds.scenes.colours import DARK, GRASS, SHELL
from worlds.scenes.shapes import (
    SOLE_THICKNESS_M,
    capsules,
    ground_mesh,
    shape_colours,
    sole_mesh,
    sole_rim,
)

RED = (200, 10, 20)


def test_capsules_reach_from_end_to_end():
    rng = np.random.default_rng(3)
    ends = rng.normal(size=(50, 2, 3))
    ends[0] = [[0, 0, 0], [0, 0, -1]]  # straight down, the turn that has no axis
    ends[1] = [[0, 0, 0], [0, 0, 1]]
    ends[2] = [[1, 0, 0], [1, 2, 0]]  # level
    drawn = capsules([Capsule(tuple(a), tuple(b), 0.1) for a, b in ends], RED)
    up = np.zeros((50, 3))
    up[:, 2] = drawn.lengths
    other = drawn.translations + Rotation.from_quat(drawn.quaternions).apply(up)
    both = np.stack([drawn.translations, other], axis=1)
    turned = np.linalg.norm(both[:, 0] - ends[:, 0], axis=1) > 1e-9
    both[turned] = both[turned, ::-1]
    np.testing.assert_allclose(both, ends, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(drawn.quaternions, axis=1), 1)


def test_spheres_are_capsules_without_length():
    shapes = [
        Capsule((1, 2, 3), (1, 2, 3), 0.5, "accent"),
        Capsule((0, 0, 0), (0, 1, 0), 0.2),
    ]
    drawn = capsules(shapes, RED)
    np.testing.assert_array_equal(drawn.lengths, [0, 1])
    np.testing.assert_array_equal(drawn.translations[0], [1, 2, 3])
    np.testing.assert_array_equal(drawn.radii, [0.5, 0.2])
    np.testing.assert_array_equal(drawn.colors, [RED, SHELL])


def test_what_is_dark_is_dark_on_every_robot():
    shape = Capsule((0, 0, 0), (0, 0, 0), 0.1, "dark")
    np.testing.assert_array_equal(shape_colours([shape], RED), [DARK])


def test_the_rim_goes_once_around_the_sole():
    foot = robots.get("nao").feet[0]
    rim_m = sole_rim(foot)
    np.testing.assert_array_equal(rim_m[0], rim_m[-1])
    np.testing.assert_array_equal(rim_m[:-1, :2], foot.outline_m)
    assert (rim_m[:, 2] == foot.sole_height_m).all()


def test_ground_normals_stand_on_the_slope():
    columns, rows = np.meshgrid(np.arange(6), np.arange(4))
    slope = Heightfield(0.1 * columns - 0.2 * rows, (0.0, 0.0), 0.5)
    mesh = ground_mesh(slope)
    normal = np.array([-0.2, 0.4, 1.0])
    expected = np.tile(normal / np.linalg.norm(normal), (24, 1))
    np.testing.assert_allclose(mesh.vertex_normals, expected, atol=1e-12)
    np.testing.assert_array_equal(mesh.vertex_positions, slope.vertices_m)
    np.testing.assert_array_equal(mesh.triangle_indices, slope.triangles)


def test_the_ground_is_a_chessboard():
    mesh = ground_mesh(Heightfield(np.zeros((2, 4)), (-0.3, 0.1), 0.25))
    first, second = GRASS
    # x is -0.3, -0.05, 0.2, 0.45 and y is 0.1, 0.35: a square is 0.25 m wide.
    row = [first, second, first, second]
    np.testing.assert_array_equal(mesh.vertex_colors, [*row, *reversed(row)])


def volume(mesh):
    corners = mesh.vertex_positions[mesh.triangle_indices]
    return np.linalg.det(corners).sum() / 6


@pytest.mark.parametrize("foot", robots.get("nao").feet)
def test_a_sole_is_closed_and_turned_outward(foot):
    mesh = sole_mesh(foot, RED)
    x, y = foot.outline_m.T
    area = abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
    np.testing.assert_allclose(volume(mesh), area * SOLE_THICKNESS_M, rtol=1e-9)
    a, b, c = np.moveaxis(mesh.vertex_positions[mesh.triangle_indices], 1, 0)
    faces = np.cross(b - a, c - a)
    normals = mesh.vertex_normals[mesh.triangle_indices]
    solid = np.linalg.norm(faces, axis=1) > 0
    assert (np.einsum("fi,fki->fk", faces, normals)[solid] > 0).all()
    assert mesh.vertex_positions[:, 2].min() == foot.sole_height_m


def test_a_sole_may_be_given_clockwise():
    square = np.array([[0, 0], [0, 0.1], [0.1, 0.1], [0.1, 0]])
    mesh = sole_mesh(Foot(0, -0.05, square, np.zeros((4, 2))), RED)
    np.testing.assert_allclose(volume(mesh), 0.01 * SOLE_THICKNESS_M, rtol=1e-9)
    assert (mesh.vertex_colors == RED).all()
