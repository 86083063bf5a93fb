import numpy as np
import pytest

from diagnosis.traces.read import read_traces
from groundwalk.errors import BadRecordingError
from worlds import Load, Recording, RecordingMetadata, write_recording
from worlds.recordings.metadata import ServoGains

ARM = """
<mujoco><worldbody><body name="a"><joint name="one" axis="0 1 0"/><geom size=".1"/>
<body name="b" pos="0 0 1"><joint name="two" axis="0 1 0"/><geom size=".1"/></body>
</body></worldbody></mujoco>
"""


@pytest.fixture
def write(tmp_path):
    """Function: writes a recording of these joints, gives its path."""
    (tmp_path / "arm.xml").write_text(ARM)

    def write(name, joints=("two", "one"), base="fixed", servo=(), loads=(), **more):
        columns = {"time": np.arange(100) * 0.01}
        for k, joint in enumerate(joints):
            columns[f"position.{joint}"] = np.full(100, float(k))
            columns[f"command.{joint}"] = np.full(100, 10.0 + k)
        columns |= more
        metadata = RecordingMetadata("arm", base, "test", dict(servo), dict(loads))
        path = tmp_path / f"{name}.parquet"
        path.parent.mkdir(exist_ok=True)
        write_recording(Recording(columns, metadata), path)
        return path

    return write


def test_columns_come_in_the_plant_s_order(write, tmp_path):
    missing = np.full(100, 3.0)
    missing[7] = np.nan
    path = write("a", **{"torque.one": missing})
    plant, (trace,) = read_traces([path], tmp_path / "arm.xml")
    assert plant.joints == ("one", "two")
    np.testing.assert_array_equal(trace.position_rad[0], [1, 0])
    np.testing.assert_array_equal(trace.command_rad[0], [11, 10])
    assert trace.velocity_rad_s is None
    assert np.isnan(trace.torque_nm[7, 0])
    assert np.isnan(trace.torque_nm[:, 1]).all()
    assert np.isfinite(np.delete(trace.torque_nm[:, 0], 7)).all()


def test_each_recording_has_its_own_loads(write, tmp_path):
    load = Load(2.0, (0.0, 0.0, 0.3))
    paths = [write("free"), write("loaded", loads={"b": load})]
    plant, traces = read_traces(paths, tmp_path / "arm.xml")
    assert [trace.loads for trace in traces] == [{}, {"b": load}]
    assert plant.loads == ({"b": load},)
    wrong = write("wrong", loads={"bb": load})
    with pytest.raises(
        BadRecordingError,
        match=r"wrong.parquet: a load is fixed to 'bb', which is no body of .*'b'\?",
    ):
        read_traces([wrong], tmp_path / "arm.xml")


def test_a_folder_stands_for_its_recordings(write, tmp_path):
    paths = [write("runs/b"), write("runs/a"), write("c")]
    (tmp_path / "runs" / "note.txt").write_text("no recording")
    _, traces = read_traces([tmp_path / "runs", paths[2]], tmp_path / "arm.xml")
    assert [trace.name for trace in traces] == ["a", "b", "c"]
    (tmp_path / "empty").mkdir()
    with pytest.raises(BadRecordingError, match=r"empty: no recording \(.parquet"):
        read_traces([tmp_path / "empty"], tmp_path / "arm.xml")


def test_paths_may_be_texts(write, tmp_path):
    path, arm = write("a"), tmp_path / "arm.xml"
    texts, paths = (read_traces([one], arm)[1] for one in (str(path), path))
    assert [one.name for one in texts] == [one.name for one in paths]


def test_each_recording_has_its_own_servo(write, tmp_path):
    paths = [
        write("a", servo={"one": ServoGains(7.0, 0.5, 2.0)}),
        write("b"),
    ]
    plant, traces = read_traces(paths, tmp_path / "arm.xml", ServoGains(4.0, 0.1, 9.0))
    np.testing.assert_array_equal(plant.servo.kp_nm_rad, [7, 4])
    np.testing.assert_array_equal(traces[0].servo.kp_nm_rad, [7, 4])
    np.testing.assert_array_equal(traces[0].servo.max_torque_nm, [2, 9])
    np.testing.assert_array_equal(traces[1].servo.kp_nm_rad, [4, 4])
    assert [trace.name for trace in traces] == ["a", "b"]


def test_recordings_must_belong_together(write, tmp_path):
    model = tmp_path / "arm.xml"
    whole, half = write("a"), write("b", joints=("one",))
    with pytest.raises(
        BadRecordingError, match=r"only one of it and .* has joint 'two'"
    ):
        read_traces([whole, half], model)
    with pytest.raises(BadRecordingError, match="its base is floating"):
        read_traces([whole, write("c", base="floating")], model)
    with pytest.raises(BadRecordingError, match="no recordings"):
        read_traces([], model)
    with pytest.raises(BadRecordingError, match="given twice"):
        read_traces([whole, whole], model)
    with pytest.raises(BadRecordingError, match=r"'too'.*did you mean 'two'"):
        read_traces([write("d", joints=("too",))], model)


def test_joints_that_are_not_recorded_are_welded(write, tmp_path):
    plant, (trace,) = read_traces([write("b", joints=("one",))], tmp_path / "arm.xml")
    assert plant.joints == ("one",)
    assert plant.model.nv == 1
    assert trace.position_rad.shape == (100, 1)


def test_same_names_in_two_folders(write, tmp_path):
    _, traces = read_traces([write("x/a"), write("y/a")], tmp_path / "arm.xml")
    assert [trace.name for trace in traces] == ["x/a", "y/a"]
