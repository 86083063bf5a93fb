"""Made-up walks of a search, and what was written of them into a Rerun file."""

import numpy as np
import pytest
from rrd_files import NAO, TICKS, entities, read, rerun, scene, view_kinds, walk_columns
from scipy.spatial.transform import Rotation
from test_rerun_meshes import CORNERS, TETRAHEDRON, described, stl

from terrain import Heightfield, make
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording
from worlds.rerun_files.search import write_search
from worlds.rerun_files.search_history import SearchHistory, SearchWalk, search_page
from worlds.rerun_files.search_walk import stills
from worlds.scenes.scene import Scene

FLAT = make("flat", 0)
FALL_X_M = 0.2 * (0.29 + 0.39)
"""Where the made-up walk has its torso at its last tick."""


def shifted(metres):
    """The made-up walk, farther ahead."""
    columns = walk_columns()
    columns["base.position.x"] = columns["base.position.x"] + metres
    return columns


def walk(ground=FLAT, ahead_m=0.0, **about):
    return SearchWalk(scene("walk", shifted(ahead_m), ground, **about), 1.25, 3.5, 3.0)


def search(walks, **more):
    count = len(walks) or 2
    return SearchHistory(
        rewards=[np.array([3.0, 1.0])] * count,
        falls=np.zeros(count),
        mean_reward=np.ones(count),
        mean={"period": np.full(count, 0.2)},
        spread={},
        best={},
        units={"reward": "cm/s"},
        walks=walks,
        **more,
    )


def written(folder, *walks):
    path = folder / "search.rrd"
    write_search(path, search(walks), "a test")
    return path


@pytest.fixture(scope="module")
def walks():
    ended = {"end": "fall"}
    return [walk(), walk(ahead_m=0.4, **ended), walk(ahead_m=-0.2)]


@pytest.fixture(scope="module")
def file(walks, tmp_path_factory):
    return written(tmp_path_factory.mktemp("walks"), *walks)


def cells(path, entity, component, size):
    """One array for each generation."""
    column = read(path, f"/search/walk/{entity}")[component]
    return [np.array(cell, float).reshape(-1, size) for cell in column.to_pylist()]


def static(path, entity, component, size):
    (cell,) = cells(path, entity, component, size)
    return cell


def test_rerun_finds_nothing_wrong_with_the_file(file):
    assert rerun("rrd", "verify", file).returncode == 0
    assert "3D" in view_kinds(file)


@pytest.mark.parametrize(
    ("ticks", "expected"),
    [(61, range(0, 61, 10)), (7, range(7)), (3, range(3)), (1, [0])],
)
def test_stills_are_spread_evenly_from_the_first_row_to_the_last(ticks, expected):
    assert stills(ticks).tolist() == list(expected)


def test_links_stand_where_the_recording_puts_them(file, walks, link_frames):
    for generation, one in enumerate(walks):
        recording = one.scene.recording
        rows = stills(recording.ticks)
        base = recording.vector("base.orientation")[rows]
        base = Rotation.from_quat(base, scalar_first=True)
        base_m = recording.vector("base.position")[rows]
        turns, places_m = link_frames(
            NAO, recording.joint_values("position", NAO.joints)[rows]
        )
        expected = {NAO.root.name: (base.as_matrix(), base_m)}
        for joint, turn, place_m in zip(NAO.links, turns, places_m, strict=True):
            turned = base * Rotation.from_matrix(turn)
            at_m = base_m + base.apply(place_m)
            if joint.link.shapes:
                expected[joint.link.name] = (turned.as_matrix(), at_m)
        for name, (matrices, at_m) in expected.items():
            entity = f"robot/{name}"
            found_m = cells(file, entity, "InstancePoses3D:translations", 3)
            np.testing.assert_allclose(found_m[generation], at_m, atol=1e-6)
            found = cells(file, entity, "InstancePoses3D:quaternions", 4)[generation]
            found = Rotation.from_quat(found).as_matrix()
            np.testing.assert_allclose(found, matrices, atol=1e-6)


def test_a_link_that_nobody_sees_is_not_there(file):
    links = [NAO.root, *(joint.link for joint in NAO.links)]
    found = {f"/search/walk/robot/{link.name}" for link in links} & entities(file)
    seen = {f"/search/walk/robot/{link.name}" for link in links if link.shapes}
    assert found == seen
    assert len(seen) < len(links)


def test_poses_are_along_the_generations_and_shapes_are_not(file):
    for entity in ("torso", "LFoot", "LFoot/sole", "RFoot/sole"):
        found = read(file, f"/search/walk/robot/{entity}")
        assert found["generation"].to_pylist() == [0, 1, 2]
        assert len(found["Mesh3D:vertex_positions"]) == 1


def test_soles_are_where_their_feet_are(file):
    component = "InstancePoses3D:translations"
    feet, soles = (
        cells(file, f"robot/RFoot{end}", component, 3) for end in ("", "/sole")
    )
    np.testing.assert_array_equal(feet, soles)


def test_a_mesh_of_the_robot_is_shown_in_place_of_round_shapes(tmp_path):
    stl(tmp_path / "one.stl", CORNERS[TETRAHEDRON])
    robot = described(tmp_path, "one.stl")
    columns = {"time": [0.0, 0.01]}
    for joint in robot.joints:
        columns[f"position.{joint}"] = columns[f"command.{joint}"] = [0.0, 0.0]
    recording = Recording(columns, RecordingMetadata("made", "floating", "a test"))
    one = SearchWalk(Scene("walk", recording, robot), 0.0, 0.02, 0.0)
    path = written(tmp_path, one)
    triangles = static(path, "robot/base", "Mesh3D:triangle_indices", 3)
    assert triangles.shape == (4, 3)
    assert "/search/walk/ground" not in entities(path)


def test_the_track_is_the_way_of_the_centre_of_mass(file, walks):
    column = read(file, "/search/walk/track")["LineStrips3D:strips"].to_pylist()
    ways_m = [np.array(strips[0]) for strips in column]
    assert [len(way_m) for way_m in ways_m] == [TICKS] * 3
    np.testing.assert_allclose(ways_m[1] - ways_m[0], [[0.4, 0, 0]] * TICKS, atol=1e-6)
    base_m = walks[0].scene.recording.vector("base.position")
    assert np.linalg.norm(ways_m[0] - base_m, axis=1).max() < 0.1


def test_a_ring_lies_where_the_robot_fell_and_nowhere_else(file):
    found = read(file, "/search/walk/fall")
    assert found["generation"].to_pylist() == [0, 1, 2]
    stood, fell, stood_again = found["LineStrips3D:strips"].to_pylist()
    assert stood == stood_again == []
    (ring_m,) = np.array(fell)
    middle_m = ring_m[:-1].mean(axis=0)
    assert abs(middle_m[0] - (FALL_X_M + 0.4)) < 0.1
    radius_m = np.linalg.norm((ring_m - middle_m)[:, :2], axis=1)
    np.testing.assert_allclose(radius_m, 0.15, atol=1e-6)
    np.testing.assert_allclose(ring_m[:, 2], 0.002, atol=1e-6)
    labels = found["LineStrips3D:labels"].to_pylist()
    assert labels == [[], ["fall at 3.50 s"], []]


@pytest.mark.parametrize(
    ("end", "is_there"),
    [("", False), ("left the ground", False), ("fall", True), ("diverged", True)],
)
def test_only_falls_have_rings(tmp_path, end, is_there):
    path = written(tmp_path, walk(end=end))
    assert ("/search/walk/fall" in entities(path)) == is_there


def test_one_ground_of_all_walks_is_there_once_and_reaches_beyond_the_robots(file):
    ground = read(file, "/search/walk/ground")
    assert "generation" not in ground
    points_m = static(file, "ground", "Mesh3D:vertex_positions", 3)
    feet = cells(file, "robot/LFoot", "InstancePoses3D:translations", 3)
    joints_m = np.vstack(feet)
    assert (points_m.min(axis=0)[:2] < joints_m.min(axis=0)[:2] - 0.3).all()
    assert (points_m.max(axis=0)[:2] > joints_m.max(axis=0)[:2] + 0.3).all()
    assert len(points_m) < FLAT.heights_m.size / 5


def test_every_walk_has_its_own_uneven_ground(tmp_path):
    grounds = [make("lumps", seed) for seed in (1, 2)]
    path = written(tmp_path, *map(walk, grounds))
    assert read(path, "/search/walk/ground")["generation"].to_pylist() == [0, 1]
    found = cells(path, "ground", "Mesh3D:vertex_positions", 3)
    for ground, points_m in zip(grounds, found, strict=True):
        x_m, y_m, z_m = points_m.T
        np.testing.assert_allclose(z_m, ground.height_at(x_m, y_m), atol=1e-5)
    assert not np.allclose(*found)
    corners = static(path, "ground", "Mesh3D:triangle_indices", 3)
    assert corners.max() == len(found[0]) - 1


def test_a_walk_that_left_its_ground_can_be_shown(tmp_path):
    small = Heightfield(np.zeros((3, 3)), (-8.0, -8.0), 0.1)
    path = written(tmp_path, walk(small))
    assert len(static(path, "ground", "Mesh3D:vertex_positions", 3)) >= 4


def test_without_walks_there_is_no_robot(tmp_path):
    path = written(tmp_path)
    assert not any("/walk" in entity for entity in entities(path))
    assert "3D" not in view_kinds(path)


def test_the_page_says_how_far_the_best_gait_walked(walks):
    history = search(walks)
    assert "walked 1.25 m in 3.50 s." in search_page(history, 0)
    assert "walked 1.25 m in 3.50 s: fall." in search_page(history, 1)
    assert "**" not in search_page(history, 0)
    assert "walked" not in search_page(search([]), 0)
    assert "cannot walk here: a reason" in search_page(
        search([], no_walks="a reason"), 0
    )


def test_the_page_doubts_a_walk_that_is_worth_something_else(walks):
    other = search([one._replace(reward=2.0) for one in walks])
    assert "worth 2.0 cm/s, the search found 3.0" in search_page(other, 0)
