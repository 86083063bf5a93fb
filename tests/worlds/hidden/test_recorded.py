import numpy as np
import pytest

from groundwalk.errors import BadValueError
from worlds.hidden.commands import CommandLine
from worlds.hidden.effects import Hidden
from worlds.hidden.plant import hidden_plant
from worlds.hidden.recorded import HiddenSensors, hidden_recording
from worlds.hidden.run import Clock, run_hidden
from worlds.recordings.metadata import RecordingMetadata

NOBODY = np.random.SeedSequence(0)


@pytest.fixture(scope="module")
def robot():
    plant = hidden_plant("nao")
    clock = Clock(0.0005, np.arange(200) * 20, 50)
    rest = plant.range_rad.mean(axis=1)
    tilted = [Hidden("ground_slope", "world", {"pitch": 0.1, "roll": 0.0})]
    return plant, run_hidden(
        plant, tilted, "bullet", clock, lambda row, sense: rest, rest, NOBODY
    )


def recorded(robot, *effects, **sensors):
    plant, run = robot
    return hidden_recording(
        plant,
        run,
        effects,
        HiddenSensors(**sensors),
        np.random.default_rng(1),
        RecordingMetadata("nao", "fixed", "test"),
    )


def test_the_log_begins_in_the_middle(robot):
    recording = recorded(robot)
    assert recording.ticks == 150
    assert recording.time_s[0] == 0.0


def test_positions_are_whole_quanta_and_speeds_their_differences(robot):
    recording = recorded(robot, quantum_rad=0.0015)
    quanta = recording.joint_values("position", ["LKneePitch"]) / 0.0015
    assert np.allclose(quanta, np.round(quanta))
    change = np.diff(recording.joint_values("position", ["LKneePitch"]), axis=0) / 0.01
    assert np.allclose(recording.joint_values("velocity", ["LKneePitch"])[1:], change)


def test_noise_is_as_strong_as_said(robot):
    _, run = robot
    recording = recorded(robot, quantum_rad=0.0, encoder_rad=0.001)
    noise = recording.joint_values("position", recording.joints) - run.encoder_rad[50:]
    assert np.std(noise) == pytest.approx(0.001, rel=0.05)


def test_a_gyroscope_s_bias_and_a_tilted_mount_are_felt(robot):
    bias = Hidden("gyro_bias", "gyroscope", {"x": 0.1, "y": -0.05, "z": 0.02})
    rate = recorded(robot, bias).vector("gyroscope").mean(axis=0)
    assert rate == pytest.approx([0.1, -0.05, 0.02], abs=0.002)
    assert np.abs(recorded(robot).vector("gyroscope").mean(axis=0)).max() < 0.002
    felt = recorded(robot).vector("accelerometer").mean(axis=0)
    assert felt == pytest.approx([-9.81 * np.sin(0.1), 0, 9.81 * np.cos(0.1)], abs=0.03)


def test_sensors_of_negative_noise_are_refused():
    with pytest.raises(BadValueError, match="encoder_rad"):
        HiddenSensors(encoder_rad=-1.0)


def test_ticks_are_late_by_no_more_than_the_jitter():
    rng = np.random.default_rng(2)
    clock = Clock.drawn(0.00025, 100.0, (0.5, 3.0), 0.001, rng)
    even = np.diff(clock.time_s) - 0.01
    assert 0.0005 < np.abs(even).max() <= 0.00226
    assert clock.time_s[clock.first] == 0.0
    assert clock.time_s[-1] == pytest.approx(3.0, abs=0.0021)
    with pytest.raises(BadValueError, match="swaps"):
        Clock.drawn(0.00025, 100.0, (0.5, 3.0), 0.02, rng)


def test_a_command_arrives_after_its_delay_to_a_part_of_a_step():
    line = CommandLine(np.zeros(1), 2.25)
    line.send(0, np.ones(1))
    whole = [line.over(step) for step in range(4)]
    assert whole == [[(1, 0)], [(1, 0)], [(0.25, 0), (0.75, 1)], [(1, 1)]]
