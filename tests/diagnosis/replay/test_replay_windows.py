"""Replays that begin in the middle of a recording: what was under way arrives."""

import numpy as np
import pytest
from joint_rigs import replayed, run_from, ticks, trace_of
from wheel_rig import wheel

from diagnosis.traces.windows import Run

TIME_S = ticks(1.2)
DELAY_S = 0.05
FIRST, LAST = 75, 105


@pytest.fixture
def swung():
    """A wheel that follows a slow swing closely, and the recording of it."""
    plant = wheel(kp=30.0, kd=1.5)
    return plant, trace_of(plant, TIME_S, command_rad=0.5 * np.sin(4 * TIME_S))


def window(trace, position, velocity, **more):
    part = trace.part(FIRST, LAST)
    return Run(part, position[FIRST], velocity[FIRST], **more)


def test_a_late_command_is_one_of_before_the_window(swung):
    plant, trace = swung
    late = ("command_latency", "commands", DELAY_S)
    position, velocity = replayed(plant, run_from(trace), late)
    whole = window(trace, position, velocity, whole=trace)
    found, _ = replayed(plant, whole, late)
    np.testing.assert_allclose(found, position[FIRST:LAST], atol=2e-5)
    forgetful, _ = replayed(plant, window(trace, position, velocity), late)
    assert np.abs(forgetful - position[FIRST:LAST]).max() > 2e-3


def test_late_encoders_measure_where_joints_have_been(swung):
    """At the window's start, too: the joints are farther by then."""
    plant, trace = swung
    late = ("sensor_delay", "encoders", DELAY_S)
    measured, velocity = replayed(plant, run_from(trace), late)
    run = window(trace, measured, velocity, whole=trace)
    found, _ = replayed(plant, run, late)
    moved = np.abs(np.diff(measured[FIRST : FIRST + 5], axis=0)).sum()
    assert moved > 0.04  # in the delay
    # all that is left is what the speed changes in that time
    assert np.abs(found - measured[FIRST:LAST]).max() < 0.15 * moved
