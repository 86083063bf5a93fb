import numpy as np
import pytest

from diagnosis.plant.servo import Servo
from diagnosis.traces import stalls
from diagnosis.traces.stalls import lag_jumps, said_of_stalls, steady
from diagnosis.traces.trace import Trace

TICK_S, JOINTS = 0.02, 4


def recording(late_s, joints=JOINTS, duration_s=40.0):
    """Joints that follow waves of their own, late by `late_s(time, joint)`."""
    time_s = np.arange(round(duration_s / TICK_S)) * TICK_S

    def wave(t, joint):
        return np.sin((3 + 0.4 * joint) * t) + 0.5 * np.sin((7 + joint) * t + joint)

    command = np.stack([wave(time_s, j) for j in range(joints)], axis=1)
    position = np.stack(
        [wave(time_s - late_s(time_s, j), j) for j in range(joints)], axis=1
    )
    noise = 0.005 * np.random.default_rng(1).standard_normal(position.shape)
    servo = Servo.ideal(joints)
    return Trace("waves", time_s, position + noise, servo, command_rad=command)


def test_a_stall_of_all_joints_is_found():
    trace = recording(lambda t, joint: 0.1 + 0.02 * joint + 0.08 * (t > 25))
    (jump,) = lag_jumps(trace)
    assert jump.time_s == pytest.approx(25.0, abs=1.0)
    assert jump.later_s == pytest.approx(0.08, abs=0.021)
    (said,) = said_of_stalls(trace)
    assert "later: the recording stalled" in said
    part = steady(trace)
    assert part.time_s[0] == 0.0
    assert 22.0 < part.time_s[-1] < 25.0
    early = recording(lambda t, joint: 0.2 - 0.08 * (t > 10))
    (jump,) = lag_jumps(early)
    assert jump.later_s < 0
    assert 10.0 < steady(early).time_s[0] < 14.0


@pytest.mark.parametrize(
    "late_s",
    [
        pytest.param(lambda t, joint: 0.1 + 0.03 * joint, id="always as late"),
        pytest.param(lambda t, joint: 0.06 + 0.003 * t, id="slower and slower"),
        pytest.param(
            lambda t, joint: 0.1 + 0.08 * ((t > 25) & (joint == 1)), id="one joint"
        ),
        pytest.param(
            lambda t, joint: 0.15 + 0.08 * (-1) ** joint * (t > 25), id="both ways"
        ),
    ],
)
def test_what_is_no_stall_is_none(late_s):
    trace = recording(late_s)
    assert lag_jumps(trace) == []
    assert steady(trace) is trace


@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
def test_joints_that_move_evenly_do_not_tell_when(factor, monkeypatch):
    """They turn at corners and lag by 0.1 s; noise decides which delay fits best."""
    monkeypatch.setattr(stalls, "SHARP", factor * stalls.SHARP)
    time_s = np.arange(2000) * TICK_S
    first, rest = np.arange(3), 3 - 0.5 * np.arange(3)

    def angle(t):
        return np.abs((t[:, None] - first) % (2 * rest) - rest)

    for seed in range(20):
        noise = 0.002 * np.random.default_rng(seed).standard_normal((2000, 3))
        position, servo = angle(time_s - 0.1) + noise, Servo.ideal(3)
        even = Trace("even", time_s, position, servo, command_rad=angle(time_s))
        assert lag_jumps(even) == []
    late = recording(lambda t, joint: 0.1 + 0.02 * joint + 0.08 * (t > 25))
    assert len(lag_jumps(late)) == 1


def test_one_or_two_joints_tell_nothing():
    trace = recording(lambda t, joint: 0.1 + 0.08 * (t > 25), joints=2)
    assert lag_jumps(trace) == []
