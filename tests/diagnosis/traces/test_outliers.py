"""Wrong samples are found in smooth motion, and nothing that joints do is one."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import ticks, trace_of
from made_up_traces import arm, arm_command

from diagnosis.traces.outliers import FAR, outliers, without_outliers

TIME_S = ticks(8.0, 0.01)


def motion(noise=3e-4, quantum=0.0):
    values = 0.8 + 0.5 * np.sin(3 * TIME_S) + 0.1 * np.sin(11 * TIME_S)
    values += noise * np.random.default_rng(1).standard_normal(len(values))
    return np.round(values / quantum) * quantum if quantum else values


@pytest.mark.parametrize("quantum", [0.0, 1.5e-3])
@pytest.mark.parametrize("length", [1, 2, 3])
def test_reads_of_0_are_found(quantum, length):
    values = motion(quantum=quantum)
    values[300 : 300 + length] = 0.0
    values[640] = 0.0
    assert np.flatnonzero(outliers(values)).tolist() == [*range(300, 300 + length), 640]


def test_a_small_slip_of_one_row_is_found():
    values = motion()
    values[300] += 0.02
    assert np.flatnonzero(outliers(values)).tolist() == [300]


def test_beside_missing_values():
    values = motion()
    values[250:260] = np.nan
    values[300] = 0.0
    assert np.flatnonzero(outliers(values)).tolist() == [300]


def steps():
    return np.where(TIME_S % 2 < 1, 0.0, 0.3)


def pulses():
    return np.where((TIME_S > 3) & (TIME_S < 3.05), 2.0, 0.1)


@pytest.mark.parametrize(
    "values",
    [
        motion(),
        motion(quantum=1.5e-3),
        steps(),
        np.cumsum(steps()) * 0.01,
        pulses(),
        np.zeros(800),
        np.full(800, np.nan),
        np.where(TIME_S > 4, motion(), 0.8),
    ],
    ids=["smooth", "rounded", "steps", "ramps", "pulse", "still", "none", "starts"],
)
def test_what_joints_do_is_no_wrong_sample(values):
    assert not outliers(values).any()


def test_a_trace_says_how_many():
    plant, time_s = arm(), ticks(4.0)
    good = trace_of(plant, time_s, arm_command(time_s), command_rad=arm_command(time_s))
    assert without_outliers(good) == (good, ())
    position = good.position_rad.copy()
    position[[120, 300], 1] = -2.0
    clean, (said,) = without_outliers(replace(good, position_rad=position))
    assert np.argwhere(np.isnan(clean.position_rad)).tolist() == [[120, 1], [300, 1]]
    assert "2 values jump away" in said
    assert clean.command_rad is good.command_rad


@pytest.mark.parametrize("far", [FAR / 2, 2 * FAR])
def test_a_factor_of_two_in_what_is_far_does_not_matter(monkeypatch, far):
    monkeypatch.setattr("diagnosis.traces.outliers.FAR", far)
    values = motion(quantum=1.5e-3)
    assert not outliers(values).any()
    assert not outliers(steps()).any()
    values[300:302] = 0.0
    assert np.flatnonzero(outliers(values)).tolist() == [300, 301]
