import numpy as np
import pytest

from robots.description import Capsule
from worlds.rerun_files.meshes import capsule_mesh
from worlds.scenes.colours import DARK

ACCENT = (1, 2, 3)
UPRIGHT = Capsule((0.1, 0.2, 0.3), (0.1, 0.2, 0.8), 0.1, "dark")
SLANTED = Capsule((0.0, 0.1, 0.2), (0.3, -0.4, -0.2), 0.05, "accent")
SPHERE = Capsule((0.5, 0.0, 0.1), (0.5, 0.0, 0.1), 0.2, "accent")


def on_axis(shape, points_m):
    """The point of a capsule's axis that is nearest to each point."""
    start, along = np.array(shape.start_m), np.subtract(shape.end_m, shape.start_m)
    length = max(np.dot(along, along), 1e-12)
    part = np.clip((points_m - start) @ along / length, 0, 1)
    return start + part[:, np.newaxis] * along


def volume(mesh):
    """By Gauss's theorem; positive if all triangles face outward."""
    a, b, c = np.moveaxis(mesh.vertex_positions[mesh.triangle_indices], 1, 0)
    return np.sum(a * np.cross(b, c)) / 6


@pytest.mark.parametrize("shape", [UPRIGHT, SLANTED, SPHERE])
def test_points_are_on_the_capsule_and_normals_point_away_from_its_axis(shape):
    mesh = capsule_mesh([shape], ACCENT)
    outward = mesh.vertex_positions - on_axis(shape, mesh.vertex_positions)
    np.testing.assert_allclose(np.linalg.norm(outward, axis=1), shape.radius_m)
    np.testing.assert_allclose(outward / shape.radius_m, mesh.vertex_normals, atol=1e-9)


@pytest.mark.parametrize("shape", [UPRIGHT, SLANTED, SPHERE])
def test_the_surface_is_closed_and_faces_outward(shape):
    mesh = capsule_mesh([shape], ACCENT)
    length = np.linalg.norm(np.subtract(shape.end_m, shape.start_m))
    round_m3 = np.pi * shape.radius_m**2 * (length + 4 / 3 * shape.radius_m)
    # Corners are on the round surface, and so the mesh is a little smaller.
    assert 0.88 * round_m3 < volume(mesh) < round_m3


def test_both_ends_are_there():
    reach = capsule_mesh([UPRIGHT], ACCENT).vertex_positions
    np.testing.assert_allclose(reach.min(axis=0), [0.0, 0.1, 0.2])
    np.testing.assert_allclose(reach.max(axis=0), [0.2, 0.3, 0.9])


def test_shapes_of_a_link_are_one_mesh_in_their_own_colours():
    both = capsule_mesh([UPRIGHT, SPHERE], ACCENT)
    alone = [capsule_mesh([shape], ACCENT) for shape in (UPRIGHT, SPHERE)]
    assert volume(both) == pytest.approx(sum(map(volume, alone)))
    points = len(alone[0].vertex_positions)
    assert (both.vertex_colors[:points] == DARK).all()
    assert (both.vertex_colors[points:] == ACCENT).all()
    assert both.triangle_indices.max() == len(both.vertex_positions) - 1
