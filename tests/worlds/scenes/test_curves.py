import numpy as np
import pytest

import robots
from worlds.recordings.metadata import RecordingMetadata
from worlds.recordings.recording import Recording
from worlds.scenes import colours
from worlds.scenes.curves import plots, support_changes, traces
from worlds.scenes.scene import Scene

NAN = np.nan


def scene(**columns):
    values = {
        "time": np.arange(6) / 100,
        "position.LKneePitch": np.arange(6.0),
        "position.RKneePitch": np.arange(6.0),
        "position.LElbowRoll": np.arange(6.0),
        "command.LKneePitch": np.arange(6.0),
    }
    values |= {key.replace("__", "."): of for key, of in columns.items()}
    metadata = RecordingMetadata("nao", "fixed", "a test")
    return Scene("sim", Recording(values, metadata), robots.get("nao"))


def test_every_joint_quantity_is_a_trace():
    by_path = {trace.path: trace for trace in traces(scene())}
    assert list(by_path) == [
        "joints/LKneePitch/position",
        "joints/RKneePitch/position",
        "joints/LElbowRoll/position",
        "joints/LKneePitch/command",
    ]
    measured = by_path["joints/LKneePitch/position"]
    np.testing.assert_array_equal(measured.values, np.arange(6.0))
    assert measured.names == ["LKneePitch position"]


def test_legs_have_the_colours_of_their_side_and_commands_are_pale():
    lines = {trace.path: trace.lines for trace in traces(scene())}
    left, right = colours.SIDES["left"], colours.SIDES["right"]
    assert lines["joints/LKneePitch/position"] == [left]
    assert lines["joints/RKneePitch/position"] == [right]
    assert lines["joints/LElbowRoll/position"] is None
    (command,) = lines["joints/LKneePitch/command"]
    assert all(a < b < 255 for a, b in zip(left, command, strict=True))


def test_sensors_are_traces_where_they_were_recorded():
    vectors = {f"gyroscope__{axis}": np.full(6, k) for k, axis in enumerate("xyz")}
    forces = {"foot_force__left": np.ones(6), "foot_force__right": np.zeros(6)}
    by_path = {trace.path: trace for trace in traces(scene(**vectors, **forces))}
    np.testing.assert_array_equal(by_path["contact/left"].values, np.ones(6))
    np.testing.assert_array_equal(by_path["contact/right"].values, np.zeros(6))
    np.testing.assert_array_equal(by_path["imu/gyroscope"].values, [[0, 1, 2]] * 6)
    assert tuple(by_path["imu/gyroscope"].names) == ("x", "y", "z")
    assert "imu/accelerometer" not in by_path


def test_plots_show_both_legs_and_command_beside_position():
    ((knee,),) = plots(scene())
    assert knee.name == "LKneePitch, RKneePitch [rad]"
    assert set(knee.paths) == {
        f"joints/{side}KneePitch/{quantity}"
        for side in "LR"
        for quantity in ("position", "command")
    }


def test_plots_show_the_sensors_that_were_recorded():
    forces = {"foot_force__left": np.ones(6), "foot_force__right": np.zeros(6)}
    _, (force,) = plots(scene(**forces))
    assert force.paths == ["contact/left", "contact/right"]


@pytest.mark.parametrize(
    ("support", "rows", "legs"),
    [
        ([1, 1, 0, -1, -1, 1], [0, 2, 3, 5], ["left", "both", "right", "left"]),
        ([NAN, 1, NAN, 1, NAN, -1], [1, 5], ["left", "right"]),
        ([NAN] * 6, [], []),
    ],
)
def test_support_changes(support, rows, legs):
    changes, states = support_changes(scene(support=np.array(support, float)))
    np.testing.assert_array_equal(changes, rows)
    assert states == legs


def test_support_may_be_unknown():
    changes, states = support_changes(scene())
    assert changes.size == 0
    assert states == []
