"""Meshes of a made-up robot, in Rerun files and as arrays."""

import struct

import numpy as np
import pytest
import trimesh
from made_up_urdf import link, two_legged
from rrd_files import components, read, rerun

import robots
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording
from worlds.rerun_files.log import write_rrd
from worlds.rerun_files.meshes import CELL_M, coarse, link_mesh
from worlds.scenes.colours import accent, pale
from worlds.scenes.scene import Scene

CORNERS = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.3]])
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
ROOT = "/sim/robot/base"
VISUAL = (
    '<visual><origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/><geometry>'
    '<mesh filename="{name}" scale="1 1 -2"/></geometry></visual>'
)
EXPECTED = [[0.1, 0.2, 0.3], [0.1, 0.3, 0.3], [-0.1, 0.2, 0.3], [0.1, 0.2, -0.3]]
"""Mirrored in z and twice as high, turned left by a quarter, moved."""


def stl(path, triangles):
    facets = [struct.pack("<12fH", 0, 0, 0, *t.ravel(), 0) for t in triangles]
    header = b"made up".ljust(80) + struct.pack("<I", len(facets))
    path.write_bytes(header + b"".join(facets))


def described(folder, *meshes):
    """The made-up robot, these files seen on its root."""
    plain, seen = (
        link("base", 5.0, (0, 0, 0.2), shapes)
        for shapes in ("", "".join(VISUAL.format(name=name) for name in meshes))
    )
    text = two_legged()
    assert plain in text
    (folder / "made.urdf").write_text(text.replace(plain, seen))
    robots.get.cache_clear()
    return robots.get(str(folder / "made.urdf"))


def written(path, robot):
    columns = {"time": [0.0]}
    for joint in robot.joints:
        columns[f"position.{joint}"] = columns[f"command.{joint}"] = [0.0]
    recording = Recording(columns, RecordingMetadata("made", "fixed", "a test"))
    write_rrd(path, [Scene("sim", recording, robot)])
    return path


def mesh_of(points_m, triangles):
    return trimesh.Trimesh(points_m, triangles, process=False)


def rows(points):
    return sorted(set(map(tuple, np.round(np.asarray(points, float), 6).tolist())))


def test_a_mesh_is_in_the_file_in_place_of_capsules(tmp_path):
    stl(tmp_path / "one.stl", CORNERS[TETRAHEDRON])
    robot = described(tmp_path, "one.stl")
    assert robot.root.shapes
    path = written(tmp_path / "walk.rrd", robot)
    assert rerun("rrd", "verify", path).returncode == 0
    root = read(path, ROOT)
    assert "Capsules3D:radii" not in root
    assert "Transform3D:translation" in root
    vertices_m = components(path, ROOT, "Mesh3D:vertex_positions", 3)
    assert rows(vertices_m) == rows(EXPECTED)
    assert components(path, ROOT, "Mesh3D:triangle_indices", 3).shape == (4, 3)
    (packed,) = root["Mesh3D:albedo_factor"].flatten().to_pylist()
    assert tuple(packed.to_bytes(4, "big")[:3]) == pale(accent(0))


@pytest.mark.parametrize("meshes", [(), ("lost.stl",), ("odd.glb",), ("hurt.stl",)])
def test_without_a_readable_mesh_there_are_capsules(tmp_path, meshes):
    (tmp_path / "odd.glb").write_bytes(b"glTF")
    (tmp_path / "hurt.stl").write_text("nothing")
    root = read(written(tmp_path / "walk.rrd", described(tmp_path, *meshes)), ROOT)
    assert "Capsules3D:radii" in root
    assert "Mesh3D:vertex_positions" not in root


def test_a_file_that_goes_after_the_robot_was_read(tmp_path):
    stl(tmp_path / "one.stl", CORNERS[TETRAHEDRON])
    robot = described(tmp_path, "one.stl")
    assert link_mesh(robot.root, (1, 2, 3)) is not None
    (tmp_path / "one.stl").unlink()
    assert link_mesh(robot.root, (1, 2, 3)) is None


def test_normals_point_outward_though_the_mesh_is_mirrored(tmp_path):
    stl(tmp_path / "one.stl", CORNERS[TETRAHEDRON])
    mesh = link_mesh(described(tmp_path, "one.stl").root, (1, 2, 3))
    inside_m = np.mean(EXPECTED, axis=0)
    corners_m = mesh.vertex_positions[mesh.triangle_indices]
    outward = corners_m.mean(axis=1) - inside_m
    a, b, c = np.moveaxis(corners_m, 1, 0)
    assert (np.sum(np.cross(b - a, c - a) * outward, axis=1) > 0).all()
    normals = mesh.vertex_normals[mesh.triangle_indices]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1)
    assert (np.sum(normals * outward[:, None], axis=2) > 0).all()


def test_meshes_of_a_link_are_one(tmp_path):
    stl(tmp_path / "one.stl", CORNERS[TETRAHEDRON])
    stl(tmp_path / "two.stl", CORNERS[TETRAHEDRON] + 1)
    one, both = (
        link_mesh(described(tmp_path, *names).root, (1, 2, 3))
        for names in (["one.stl"], ["one.stl", "two.stl", "lost.stl"])
    )
    assert len(one.triangle_indices) == 4
    assert len(both.triangle_indices) == 8


def test_coarse_drops_what_is_smaller_than_a_cell_and_moves_no_point():
    """Two tetrahedra, the second one inside a cell; facets share no points before."""
    points_m = CORNERS[TETRAHEDRON].reshape(-1, 3)
    small_m = 0.5 + 0.1 * CELL_M + CELL_M * points_m
    triangles = np.arange(24).reshape(-1, 3)
    found = coarse(mesh_of(np.vstack([points_m, small_m]), triangles))
    kept = found.vertices[found.faces]
    np.testing.assert_array_equal(kept, CORNERS[TETRAHEDRON])
    fine = coarse(mesh_of(np.vstack([points_m, small_m]), triangles), CELL_M / 1e4)
    assert fine.faces.shape == (8, 3)
    assert fine.vertices.shape == (8, 3)


def test_coarse_keeps_one_of_equal_triangles_and_takes_nothing():
    twice = np.array([[0, 1, 2], [2, 1, 0], [1, 2, 3]])
    found = coarse(mesh_of(CORNERS, twice))
    assert len(found.faces) == 2
    nothing = coarse(mesh_of(np.empty((0, 3)), np.empty((0, 3), np.intp)))
    assert nothing.faces.shape == (0, 3)
