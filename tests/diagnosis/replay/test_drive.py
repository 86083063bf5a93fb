"""Commands on the steps of a replay: means over steps, delays, missing values."""

import numpy as np
import pytest
from joint_rigs import ARM, WHEEL, plant_of, run_from, trace_of

from diagnosis.replay.drive import Drive, Held

NAN = np.nan


def held(time_s, *columns):
    return Held(np.array(time_s, float), np.array(columns, float).T)


def test_a_step_takes_the_mean_of_what_holds_during_it():
    steps = held([0, 1, 2, 5], [1, 3, -2, 7], [0, 0, 1, 0])
    means = steps.mean(np.array([0.2, 0.75, 1.5, 4.0]), 0.5)
    first = [1.0, (0.25 * 1 + 0.25 * 3) / 0.5, 3.0, -2.0]
    np.testing.assert_allclose(means, np.array([first, [0, 0, 0, 1]]).T, atol=1e-12)


def test_a_step_over_several_rows():
    steps = held([0, 0.1, 0.2, 0.3], [1, 2, 4, 8])
    mean = steps.mean(np.array([0.05]), 0.2)
    np.testing.assert_allclose(mean, [[(0.05 * 1 + 0.1 * 2 + 0.05 * 4) / 0.2]])


def test_ends_hold():
    steps = held([1, 2], [3, 5])
    means = steps.mean(np.array([-10.0, 0.9, 1.9, 2.0, 30.0]), 0.2)
    np.testing.assert_allclose(means[:, 0], [3, 3, 4, 5, 5])


@pytest.mark.parametrize(
    ("given", "used"),
    [
        ([1, NAN, NAN, 4], [1, 1, 1, 4]),
        ([NAN, NAN, 3, 4], [3, 3, 3, 4]),
        ([1, 2, NAN, NAN], [1, 2, 2, 2]),
    ],
)
def test_a_missing_value_is_the_one_before_it(given, used):
    time_s = np.arange(4.0)
    rows = held(time_s, given, [5, 6, 7, 8]).mean(time_s, 1.0)
    np.testing.assert_allclose(rows, np.array([used, [5, 6, 7, 8]]).T)


def arm_run(time_s, kp=1.0, **channels):
    plant = plant_of(ARM, kp=kp)
    return run_from(trace_of(plant, np.asarray(time_s, float), **channels))


def test_variants_are_late_and_runs_keep_their_own_times():
    """Delays need not be whole steps; rows are variant by variant."""
    command = np.array([[0, 10], [1, 20], [2, 30], [3, 40.0]])
    runs = [
        arm_run([0, 1, 2, 3], command_rad=command),
        arm_run([100, 101, 102, 103], command_rad=-command),
    ]
    drive = Drive(runs, np.array([0.0, 0.75, 0.0]), 0.5)
    asked, torque = drive.at(np.array([[0.5, 100.5], [2.5, 102.5]]))
    assert torque is None
    assert asked.shape == (2, 6, 2)
    np.testing.assert_allclose(asked[0, 0::2], [[0, 10], [0, 10], [0, 10]])
    # from 1.75 to 2.25: half of row 1, half of row 2
    np.testing.assert_allclose(asked[1, 0::2], [[2, 30], [1.5, 25], [2, 30]])
    np.testing.assert_allclose(asked[:, 1::2], -asked[:, 0::2])


def test_position_targets_go_before_torques_and_targets_before_measurements():
    time_s, now = np.arange(3.0), np.array([[1.0]])
    one, two, three = (np.full((3, 2), value) for value in (1.0, 2.0, 3.0))
    torques = {"command_torque_nm": two, "torque_nm": three}
    everything = arm_run(time_s, command_rad=one, **torques)
    for run, asked, torque in (
        (everything, 1.0, None),
        (arm_run(time_s, kp=0.0, command_rad=one, **torques), None, 2.0),
        (arm_run(time_s, **torques), None, 2.0),
        (arm_run(time_s, torque_nm=three), None, 3.0),
        (arm_run(time_s), None, None),
    ):
        found = Drive([run], np.zeros(1), 0.1).at(now)
        for values, wanted in zip(found, (asked, torque), strict=True):
            if wanted is None:
                assert values is None
            else:
                np.testing.assert_allclose(values, np.full((1, 1, 2), wanted))


def test_ends_of_steps_are_what_holds_there():
    """Of a jump within a step both sides, and the mean says when it was."""
    command = np.array([[0, 10], [1, 20], [2, 30], [3, 40.0]])
    drive = Drive([arm_run([0, 1, 2, 3], command_rad=command)], np.zeros(1), 0.5)
    before, after = drive.ends(np.array([[0.25], [0.75], [2.5]]))
    np.testing.assert_allclose(before[:, 0], [[0, 10], [0, 10], [2, 30]])
    np.testing.assert_allclose(after[:, 0], [[0, 10], [1, 20], [3, 40]])
    asked, _ = drive.at(np.array([[0.75]]))
    np.testing.assert_allclose(asked[0, 0], [0.5, 15])
    torques = arm_run(np.arange(3.0), torque_nm=np.ones((3, 2)))
    assert Drive([torques], np.zeros(1), 0.1).ends(np.array([[1.0]])) is None


def test_torques_are_late_too():
    plant = plant_of(WHEEL)
    trace = trace_of(plant, np.arange(3.0), command_torque_nm=[0.0, 1.0, 2.0])
    _, torque = Drive([run_from(trace)], np.array([0.25]), 1.0).at(np.array([[1.0]]))
    np.testing.assert_allclose(torque, [[[0.75]]])
