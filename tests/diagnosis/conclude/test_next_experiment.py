"""The recording that tells two answers apart, by what they predict of it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import replayed, run_from, trace_of
from made_up_search import VALUES, found
from made_up_traces import arm, recorded

from diagnosis.conclude.next_experiment import (
    REACH,
    STIFFER,
    TICK_S,
    next_experiment,
)
from diagnosis.motions.shapes import MOTIONS
from diagnosis.traces.usage import Usage

PLANT = arm()
FRICTION, ARMATURE = "viscous_friction@elbow", "armature@elbow"


@pytest.fixture(scope="module")
def traces():
    return [recorded(PLANT, duration_s=2.0)]


def apart_mrad(traces, motion, *keys):
    """What two effects differ by: an own replay of the motion."""
    usage = Usage.of(PLANT, traces)
    motion = {one.words: one for one in MOTIONS}[motion]
    time_s = np.arange(0, motion.duration_s, TICK_S)
    half = REACH * (usage.high_rad - usage.low_rad) / 2
    middle = (usage.high_rad + usage.low_rad) / 2
    command = middle + half * motion.shape(time_s, motion.duration_s)[:, None]
    run = run_from(trace_of(PLANT, time_s, command_rad=command), command[0])
    one, other = (
        replayed(PLANT, run, (*key.split("@"), *VALUES[key.split("@")[0]]))[0]
        for key in keys
    )
    return 1e3 * np.sqrt(np.mean((one - other) ** 2))


def number_of(text):
    return float(re.search(r"by ([\d.]+) mrad", text)[1])


def test_the_motion_that_tells_most(traces):
    rivals = FRICTION, ARMATURE
    tied = found(PLANT, (100.0, rivals[0]), (101.0, rivals[1]))
    answer = next_experiment(PLANT, tied, traces)
    apart = {one.words: apart_mrad(traces, one.words, *rivals) for one in MOTIONS}
    best = max(apart, key=apart.get)
    assert answer.motion.split(";")[0] == best
    assert apart[best] > 5 * min(apart.values())
    assert answer.joint == "elbow"
    told = "viscous friction at elbow", "rotor inertia at elbow"
    assert all(words in answer.why for words in told)
    if answer.motion == best:
        assert number_of(answer.why) == pytest.approx(apart[best], rel=0.05)


def test_what_only_another_servo_tells_apart(traces, monkeypatch):
    """Friction of 0.1 and a twentieth more of the servo's damping of 2 are one."""
    monkeypatch.setitem(VALUES, "servo_damping", (1.05,))
    damping = "servo_damping@elbow"
    tied = found(PLANT, (100.0, FRICTION), (100.0, damping))
    answer = next_experiment(PLANT, tied, traces)
    assert answer.motion.endswith(STIFFER)
    motion = answer.motion.split(";")[0]
    assert apart_mrad(traces, motion, FRICTION, damping) < 0.01
    assert number_of(answer.why) > 0.1


def test_of_clear_answers_nothing_is_asked(traces):
    clear = found(PLANT, (100.0, FRICTION), (300.0, ARMATURE))
    assert next_experiment(PLANT, clear, traces) is None
    alone = found(PLANT, (100.0, FRICTION))
    assert next_experiment(PLANT, alone, traces) is None


def test_without_commands_there_is_nothing_to_choose(traces):
    tied = found(PLANT, (100.0, FRICTION), (101.0, ARMATURE))
    (trace,) = traces
    torques = np.zeros_like(trace.position_rad)
    driven = replace(trace, command_rad=None, command_torque_nm=torques)
    assert next_experiment(PLANT, tied, [driven]) is None
