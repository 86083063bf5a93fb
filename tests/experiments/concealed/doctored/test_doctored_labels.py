"""What is changed in the labels of a recording, and what stays."""

import numpy as np
import pytest

from experiments.concealed.doctored import labels
from worlds.recordings import Recording, RecordingMetadata, ServoGains

SERVO = {"hip": ServoGains(20.0, 1.0, 5.0), "knee": ServoGains(30.0, 2.0, 6.0)}


@pytest.fixture
def recording():
    rows = np.arange(50.0)
    columns = {"time": 3.0 + 0.01 * rows}
    for k, joint in enumerate(SERVO):
        for j, quantity in enumerate(("position", "velocity", "command", "torque")):
            columns[f"{quantity}.{joint}"] = rows + 100 * k + 1000 * j
    return Recording(columns, RecordingMetadata("leg.xml", "fixed", "", SERVO))


def changed(before, after):
    """Names of the columns that differ."""
    return {
        name
        for name, values in before.columns.items()
        if not np.array_equal(values, after.columns[name])
    }


def test_only_one_stiffness_is_declared_wrong(recording):
    found = labels.declare_gain(recording, "knee", 1.5)
    assert found.metadata.servo["knee"] == ServoGains(45.0, 2.0, 6.0)
    assert found.metadata.servo["hip"] == SERVO["hip"]
    assert changed(recording, found) == set()


def test_commands_come_earlier_and_nothing_else_does(recording):
    found = labels.hurry_commands(recording, 3)
    assert found.ticks == 47
    command, position = (found.columns[f"{q}.hip"] for q in ("command", "position"))
    assert command == pytest.approx(recording.columns["command.hip"][3:])
    assert position == pytest.approx(recording.columns["position.hip"][:47])
    assert np.diff(found.time_s) == pytest.approx(0.01)


def test_a_zero_is_that_of_commands_too(recording):
    found = labels.shift_zero(recording, "hip", -0.05)
    assert changed(recording, found) == {"position.hip", "command.hip"}
    for name in ("position.hip", "command.hip"):
        shift = found.columns[name] - recording.columns[name]
        assert shift == pytest.approx(-0.05)


def test_one_torque_is_scaled(recording):
    found = labels.scale_torque(recording, "hip", 0.8)
    assert changed(recording, found) == {"torque.hip"}
    ratio = found.columns["torque.hip"] / recording.columns["torque.hip"]
    assert ratio == pytest.approx(0.8)


def test_what_two_joints_measure_is_exchanged(recording):
    found = labels.swap_joints(recording, "hip", "knee")
    for quantity in ("position", "velocity"):
        one, other = f"{quantity}.hip", f"{quantity}.knee"
        assert (found.columns[one] == recording.columns[other]).all()
        assert (found.columns[other] == recording.columns[one]).all()
    assert "command.hip" not in changed(recording, found)
    back = labels.swap_joints(found, "knee", "hip")
    assert changed(recording, back) == set()


def test_the_clock_runs_wrong_by_a_factor(recording):
    found = labels.scale_time(recording, 1.02)
    assert changed(recording, found) == {"time"}
    assert labels.tick_s(found) == pytest.approx(0.0102)
