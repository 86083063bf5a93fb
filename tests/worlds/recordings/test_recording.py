import pickle

import numpy as np
import pytest

from groundwalk.errors import BadRecordingError, UnknownNameError
from worlds.recordings.metadata import RecordingMetadata, ServoGains
from worlds.recordings.recording import Recording

METADATA = RecordingMetadata("nao", "floating", "a test")
COLUMNS = {
    "time": [0.0, 0.5, 2.0, 2.25],
    "position.knee": [1.0, 2.0, 3.0, 4.0],
    "position.hip": [5.0, 6.0, 7.0, 8.0],
    "velocity.hip": [0.1, 0.2, 0.3, 0.4],
    "command.hip": [9.0, 10.0, 11.0, 12.0],
    "command.knee": [13.0, 14.0, 15.0, 16.0],
    "command_torque.knee": [17.0, 18.0, 19.0, 20.0],
    "torque.knee": [21.0, 22.0, 23.0, np.nan],
    "foot_force.right": [1.0, 0.0, 1.0, 0.0],
    "foot_force.left": [2.0, 3.0, 4.0, 5.0],
}


@pytest.fixture
def recording():
    return Recording(COLUMNS, METADATA)


def test_sizes(recording):
    np.testing.assert_array_equal(recording.time_s, [0.0, 0.5, 2.0, 2.25])
    assert recording.ticks == 4
    assert recording.duration_s == 2.25
    assert recording.joints == ("knee", "hip")


def test_values_come_in_the_order_that_is_asked_for(recording):
    np.testing.assert_array_equal(
        recording.joint_values("position", ["hip", "knee"]),
        [[5, 1], [6, 2], [7, 3], [8, 4]],
    )
    np.testing.assert_array_equal(
        recording.joint_values("command", ["knee", "hip"]),
        [[13, 9], [14, 10], [15, 11], [16, 12]],
    )
    np.testing.assert_array_equal(
        recording.joint_values("velocity", ["hip"]), [[0.1], [0.2], [0.3], [0.4]]
    )
    np.testing.assert_array_equal(
        recording.joint_values("torque", ["knee"]), [[21], [22], [23], [np.nan]]
    )


def test_no_joints_give_no_columns(recording):
    assert recording.joint_values("position", []).shape == (4, 0)


def test_joints_with_a_quantity(recording):
    assert recording.joints_with("command") == ("hip", "knee")
    assert recording.joints_with("velocity") == ("hip",)
    with pytest.raises(UnknownNameError, match="did you mean 'velocity'"):
        recording.joints_with("velocty")


def test_a_joint_without_the_column_is_an_error(recording):
    with pytest.raises(UnknownNameError, match="'kne': did you mean 'knee'"):
        recording.joint_values("position", ["hip", "kne"])
    with pytest.raises(UnknownNameError, match="joint with a velocity 'knee'"):
        recording.joint_values("velocity", ["knee"])


def test_vectors(recording):
    assert recording.has("foot_force")
    assert not recording.has("gyroscope")
    np.testing.assert_array_equal(
        recording.vector("foot_force"), [[2, 1], [3, 0], [4, 1], [5, 0]]
    )
    with pytest.raises(UnknownNameError, match="known are foot_force"):
        recording.vector("gyroscope")
    with pytest.raises(UnknownNameError, match="did you mean 'gyroscope'"):
        recording.has("gyroscop")


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"postion.knee": [0.0] * 4}, "unknown column 'postion.knee'"),
        ({"support": [0.0]}, "'support' has 1 rows"),
        ({"support": [0.0, 1.0, 2.0, 0.0]}, "'support', row 2 "),
    ],
)
def test_construction_checks_names_lengths_and_values(changes, problem):
    with pytest.raises(BadRecordingError, match=problem):
        Recording(COLUMNS | changes, METADATA)


def test_a_servo_belongs_to_a_joint():
    gains = ServoGains(20.0, 1.0, 5.0)
    right = RecordingMetadata("nao", "fixed", "", servo={"hip": gains})
    assert Recording(COLUMNS, right).metadata.servo == {"hip": gains}
    wrong = RecordingMetadata("nao", "fixed", "", servo={"hop": gains})
    with pytest.raises(BadRecordingError, match=r"'hop'.*did you mean 'hip'"):
        Recording(COLUMNS, wrong)


def test_a_recording_cannot_be_changed(recording):
    with pytest.raises(ValueError, match="read-only"):
        recording.time_s[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        recording.columns["position.knee"][0] = 1.0


def test_a_recording_travels_between_processes(recording):
    there = pickle.loads(pickle.dumps(recording))
    assert there.metadata == recording.metadata
    np.testing.assert_equal(there.columns, recording.columns)


def test_a_recording_equals_only_itself(recording):
    assert recording == recording
    assert recording != Recording(COLUMNS, METADATA)
    assert len({recording, recording}) == 1
