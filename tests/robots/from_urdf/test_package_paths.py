"""Files that a URDF names."""

import re

import pytest

from groundwalk.errors import BadModelError
from robots.from_urdf.mesh_files import example_robots, mesh_path


@pytest.fixture
def urdf(tmp_path):
    """A URDF in a package with a mesh."""
    folder = tmp_path / "share" / "bot"
    (folder / "meshes").mkdir(parents=True)
    (folder / "urdf").mkdir()
    (folder / "meshes" / "foot.stl").touch()
    path = folder / "urdf" / "bot.urdf"
    path.touch()
    return path


def test_beside_and_in_the_package(urdf):
    mesh = urdf.parent.parent / "meshes" / "foot.stl"
    for name in (
        "../meshes/foot.stl",
        "package://bot/meshes/foot.stl",
        f"file://{mesh}",
    ):
        assert mesh_path(urdf, name).samefile(mesh)


def test_where_ros_looks(urdf, tmp_path, monkeypatch):
    other = tmp_path / "elsewhere" / "hand"
    other.mkdir(parents=True)
    (other / "finger.stl").touch()
    with pytest.raises(BadModelError, match="ROS_PACKAGE_PATH"):
        mesh_path(urdf, "package://hand/finger.stl")
    monkeypatch.setenv("ROS_PACKAGE_PATH", f"/nowhere:{other.parent}")
    assert mesh_path(urdf, "package://hand/finger.stl") == other / "finger.stl"


def test_examples():
    assert {"g1_29dof_rev_1_0", "talos_reduced"} <= set(example_robots())


def test_a_copied_example_finds_its_meshes(tmp_path, monkeypatch):
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    copy = tmp_path / "mine.urdf"
    copy.write_text(example_robots()["talos_reduced"].read_text())
    names = re.findall(r'"(package://[^"]+)"', copy.read_text())
    assert names
    assert mesh_path(copy, names[0]).name == names[0].rpartition("/")[2]
