import json
import subprocess
import sys

import numpy as np
import pytest
from rerun.chunk import RrdReader
from rrd_files import (
    NAO,
    TICKS,
    components,
    entities,
    read,
    rerun,
    scalars,
    scene,
    ticks,
    view_kinds,
    walk_columns,
)

from groundwalk.errors import BadValueError
from terrain import make
from worlds.rerun_files.log import write_rrd


@pytest.fixture(scope="module")
def walk():
    return scene(ground=make("waves", 1), end="fall", world="real", gait={"speed": 0.2})


def test_rerun_finds_nothing_wrong_with_the_file(file, tmp_path):
    assert rerun("rrd", "verify", file).returncode == 0
    half = tmp_path / "half.rrd"
    half.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    assert rerun("rrd", "verify", half).returncode != 0


def test_joints_are_as_recorded(file, walk):
    for quantity in ("position", "velocity", "command"):
        for joint in NAO.joints:
            np.testing.assert_array_equal(
                scalars(file, f"/sim/joints/{joint}/{quantity}"),
                walk.recording.columns[f"{quantity}.{joint}"],
            )


def test_timelines_are_the_time_and_the_row(file):
    position = read(file, "/sim/joints/LKneePitch/position")
    # 0.32 s is 319999999.99999994 ns in floating point: rounded, not cut off.
    expected_ns = 290_000_000 + 10_000_000 * np.arange(TICKS)
    nanoseconds = position["sim_time"].cast("int64").to_numpy()
    np.testing.assert_array_equal(nanoseconds, expected_ns)
    np.testing.assert_array_equal(position["tick"].to_numpy(), np.arange(TICKS))


@pytest.mark.parametrize("sensor", ["gyroscope", "accelerometer"])
def test_inertial_sensors_are_as_recorded(file, walk, sensor):
    np.testing.assert_array_equal(
        scalars(file, f"/sim/imu/{sensor}").reshape(-1, 3),
        walk.recording.vector(sensor),
    )


def test_foot_forces_are_sums_and_arrows_at_the_sensors(file, walk):
    time_s = walk.recording.time_s
    np.testing.assert_allclose(scalars(file, "/sim/contact/left"), 10 * time_s)
    force = "/sim/robot/RFoot/force"
    arrows_m = components(file, force, "Arrows3D:vectors", 3).reshape(-1, 4, 3)
    expected_m = 0.005 * np.outer(time_s, [4, 3, 2, 1])
    np.testing.assert_allclose(arrows_m[:, :, 2], expected_m, rtol=1e-6)
    assert (arrows_m[:, :, :2] == 0).all()
    origins_m = components(file, force, "Arrows3D:origins", 3)
    np.testing.assert_allclose(origins_m[:, :2], NAO.feet[1].sensors_m, rtol=1e-6)


def test_links_are_where_the_joints_put_them(file, walk):
    torso = "/sim/robot/torso"
    turns = components(file, torso, "Transform3D:quaternion", 4)
    angles = 0.5 * walk.recording.time_s
    expected = np.stack(
        [0 * angles, 0 * angles, np.sin(angles / 2), np.cos(angles / 2)]
    )
    np.testing.assert_allclose(turns, expected.T, atol=1e-6)
    for name, pose in walk.link_poses().items():
        places = components(file, f"/sim/robot/{name}", "Transform3D:translation", 3)
        np.testing.assert_allclose(places, pose.position_m, atol=1e-6)


def test_links_have_shapes_and_feet_have_soles(file):
    for link in (NAO.root, *(joint.link for joint in NAO.links)):
        found = read(file, f"/sim/robot/{link.name}")
        drawn = found["Capsules3D:radii"].flatten() if link.shapes else []
        assert len(drawn) == len(link.shapes)
    for link in ("LFoot", "RFoot"):
        assert "Mesh3D:triangle_indices" in read(file, f"/sim/robot/{link}/sole")


def test_the_ground_is_the_heightfield(file, walk):
    vertices_m = components(file, "/sim/ground", "Mesh3D:vertex_positions", 3)
    np.testing.assert_allclose(vertices_m, walk.ground.vertices_m, atol=1e-6)
    corners = components(file, "/sim/ground", "Mesh3D:triangle_indices", 3)
    np.testing.assert_array_equal(corners, walk.ground.triangles)


def test_support_changes_and_the_end_are_marked(file):
    support = read(file, "/sim/support")
    legs = support["StateChange:state"].flatten().to_pylist()
    assert legs == ["both", "left", "right", "left"]
    assert support["tick"].to_pylist() == [0, 10, 20, 30]
    end = read(file, "/sim/events")
    assert end["TextLog:text"].to_pylist() == [["fall"]]
    assert end["TextLog:level"].to_pylist() == [["WARN"]]
    assert end["tick"].to_pylist() == [TICKS - 1]


def test_an_end_that_is_no_failure_is_no_warning(tmp_path):
    path = tmp_path / "walk.rrd"
    write_rrd(path, [scene(end="course walked")])
    assert read(path, "/sim/events")["TextLog:level"].to_pylist() == [["INFO"]]


def test_metadata_are_properties(file):
    properties = read(file, "/__properties/sim")
    assert properties["robot"].to_pylist() == [["nao"]]
    assert properties["end"].to_pylist() == [["fall"]]
    assert json.loads(properties["gait"].to_pylist()[0][0]) == {"speed": 0.2}
    assert "terrain" not in properties


def test_the_file_brings_its_own_layout(file):
    assert view_kinds(file) == {"3D", "TimeSeries", "StateTimeline"}


def test_scenes_stand_side_by_side(tmp_path):
    path = tmp_path / "new" / "both.rrd"
    slower = {**walk_columns(), "time": 0.02 * np.arange(TICKS)}
    write_rrd(path, [scene("start/sim"), scene("start/real", slower)])
    assert rerun("rrd", "verify", path).returncode == 0
    found = entities(path)
    for entity in ("joints/LKneePitch/position", "robot/LFoot", "support"):
        assert {f"/start/sim/{entity}", f"/start/real/{entity}"} <= found
    times = [
        read(path, f"/start/{name}/imu/gyroscope")["sim_time"].cast("int64")[-1].as_py()
        for name in ("sim", "real")
    ]
    assert times == [680_000_000, 780_000_000]


def test_rows_with_missing_values_are_left_out(tmp_path):
    columns = walk_columns()
    columns["position.LKneePitch"][5] = np.nan
    columns["gyroscope.y"][7:9] = np.nan
    columns["foot_force.left.rear_left"][3] = np.nan
    columns["velocity.LKneePitch"][:] = np.nan
    path = tmp_path / "gaps.rrd"
    write_rrd(path, [scene(columns=columns)])

    without = {row: np.delete(np.arange(TICKS), row) for row in (3, 5)}
    knee = "/sim/joints/LKneePitch"
    np.testing.assert_array_equal(ticks(path, f"{knee}/position"), without[5])
    assert not np.isnan(scalars(path, f"{knee}/position")).any()
    assert ticks(path, f"{knee}/command").size == TICKS
    np.testing.assert_array_equal(ticks(path, "/sim/robot/LFoot"), without[5])
    assert ticks(path, "/sim/robot/RFoot").size == TICKS
    gyroscope = ticks(path, "/sim/imu/gyroscope")
    np.testing.assert_array_equal(gyroscope, np.delete(np.arange(TICKS), [7, 8]))
    np.testing.assert_array_equal(ticks(path, "/sim/contact/left"), without[3])
    np.testing.assert_array_equal(ticks(path, "/sim/robot/LFoot/force"), without[3])
    assert "Scalars:scalars" not in read(path, f"{knee}/velocity")


def test_the_least_that_a_recording_can_be(tmp_path):
    columns = {"time": [0.0], "position.LKneePitch": [0.5], "torque.LKneePitch": [1.0]}
    path = tmp_path / "least.rrd"
    write_rrd(path, [scene(columns=columns)])
    assert rerun("rrd", "verify", path).returncode == 0
    place = components(path, "/sim/robot/torso", "Transform3D:translation", 3)
    np.testing.assert_array_equal(place, [[0, 0, 0]])
    assert scalars(path, "/sim/joints/LKneePitch/torque") == [1.0]
    assert not {"/sim/ground", "/sim/support", "/sim/events"} & entities(path)
    assert view_kinds(path) == {"3D"}


def test_the_id_follows_from_the_contents_unless_it_is_given(tmp_path):
    def identity(scenes, **given):
        path = tmp_path / "walk.rrd"
        write_rrd(path, scenes, **given)
        (recording,) = RrdReader(path).recordings()
        return recording.recording_id

    assert identity([scene()]) == identity([scene()])
    assert identity([scene()]) != identity([scene("real")])
    assert identity([scene()], recording_id="trial 7") == "trial 7"


def test_what_cannot_be_written_leaves_the_old_file(tmp_path):
    path = tmp_path / "walk.rrd"
    path.write_bytes(b"old")
    with pytest.raises(BadValueError, match="'sim'"):
        write_rrd(path, [scene(), scene()])
    assert path.read_bytes() == b"old"
    write_rrd(path, [scene()])
    assert [found.name for found in tmp_path.iterdir()] == ["walk.rrd"]


def test_rerun_is_imported_only_when_a_file_is_written():
    imports = "import sys, worlds.rerun_files.log, worlds.rerun_files.viewer"
    code = f"{imports}; sys.exit('rerun' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
