"""Each second of a recording is told once, with what happened in it."""

import numpy as np
import pytest
from test_stalls import JOINTS, recording

from diagnosis.traces.split import Split, split
from diagnosis.traces.time_line import Stretch, time_line
from diagnosis.verdict import Found, Pulse, When

NAMES = [f"joint_{k}" for k in range(JOINTS)]


def steady_recording():
    return recording(lambda t, joint: 0.1 + 0.02 * joint)


def told(trace, parts, **found):
    return time_line(NAMES, [trace], parts, **found)


def test_parts_and_what_is_left_out_fill_a_recording():
    trace = steady_recording()
    parts = split([trace])
    uses = told(trace, parts)
    assert [one.what for one in uses].count("fitted") == len(parts.fit)
    assert {one.what for one in uses} == {"fitted", "selected", "held out"}
    covered = sum(one.end_s - one.start_s for one in uses)
    assert covered == pytest.approx(trace.duration_s, abs=0.25 * len(uses))
    half = trace.part(0, trace.ticks // 2)
    *_, rest = told(trace, split([half]))
    assert rest.what == "not used"
    assert rest.why == "what was used is enough"
    assert (rest.start_s, rest.end_s) == (half.time_s[-1], trace.time_s[-1])


def test_a_recording_that_was_not_used_at_all():
    trace = steady_recording()
    (one,) = told(trace, Split((), (), ()))
    assert one == Stretch("waves", 0.0, trace.time_s[-1], "not used", "", one.why)


def test_a_stall_and_what_lies_beside_it():
    trace = recording(lambda t, joint: 0.1 + 0.02 * joint + 0.08 * (t > 25))
    events = told(trace, split([trace.part(0, 1150)]))
    (stall,) = [one for one in events if one.what == "stall"]
    assert stall.start_s == pytest.approx(25.0, abs=1.0)
    assert "later" in stall.why
    (rest,) = [one for one in events if one.what == "not used"]
    assert rest.why == "beside a stall"


def test_wrong_samples_are_told_by_channel():
    trace = steady_recording()
    trace.position_rad[700, 2] = 9.0
    events = told(trace, split([trace]))
    (wrong,) = [one for one in events if one.what == "wrong sample"]
    assert (wrong.channel, wrong.start_s) == ("position.joint_2", trace.time_s[700])


def test_pulses_and_bursts_are_told_where_they_were():
    trace = steady_recording()
    size = 3.0, 3.5, 2.0, "N m", "actuator input", {}, 1.0
    pulse, other = (Pulse(name, "joint_1", *size) for name in ("waves", "steps"))

    def push(end_s, name):
        when = When("burst", 7.0, end_s, name)
        return Found("external_force", "hand", {}, None, when=when)

    lasting = Found("coulomb_friction", "joint_0", {}, None)
    found = [push(99.0, "waves"), push(9.0, "steps"), lasting]
    events = told(trace, split([trace]), pulses=[pulse, other], effects=found)
    pushes = [one for one in events if one.what in ("pulse", "effect")]
    assert [(one.what, one.start_s, one.channel) for one in pushes] == [
        ("pulse", 3.0, "joint_1"),
        ("effect", 7.0, "hand"),
    ]
    assert "2 N m" in pushes[0].why
    assert pushes[1].end_s == trace.time_s[-1]


def test_recordings_are_told_in_their_order():
    first, second = steady_recording(), steady_recording()
    object.__setattr__(second, "name", "a later one")
    parts = split([first, second])
    order = [one.recording for one in time_line(NAMES, [first, second], parts)]
    assert order == sorted(order, key=["waves", "a later one"].index)
    assert np.unique(order).size == 2
