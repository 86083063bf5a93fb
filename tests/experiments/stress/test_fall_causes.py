"""Falls whose cause is built in are told apart: a confusion table for both worlds."""

import dataclasses
import math
from collections import Counter

import pytest
from built_falls import edge, flat, pushed, slope, strider, walk, weak

import robots
from experiments.stress import fall_cause as events
from experiments.stress.fall_cause import Cause, fall_cause
from experiments.stress.fall_cause_signals import Signals
from experiments.stress.families import leg_length_m
from walk_engine import gaits

ICE = 0.1
SIDEWAYS, UPHILL = math.pi / 2, 0.0
SIDE_N, AHEAD_N = 60.0, 60.0


def walked(world, seeds):
    """Scenes by the cause that is built in, with whether each robot fell."""
    start = gaits.get("start")
    step = edge(leg_length_m(robots.get("nao")), 0.3)
    icy = {"friction": ICE, "limit_s": 4.0}
    yield Cause.TRIP, walk(world, start, step, seeds=seeds, limit_s=4.0)
    yield Cause.SLIP, walk(world, strider(), slope(0.2, SIDEWAYS), seeds=seeds, **icy)
    # the same slope without ice
    yield Cause.SIDEWAYS_TIP, walk(world, strider(), slope(0.2, SIDEWAYS), limit_s=4.0)
    lame = weak(0.1, "KneePitch")
    yield Cause.MOTOR_LIMIT, walk(world, start, flat(), description=lame, limit_s=3.0)


def pushes(engine):
    yield Cause.SIDEWAYS_TIP, pushed(engine, (0, SIDE_N))
    yield Cause.SIDEWAYS_TIP, pushed(engine, (0, -SIDE_N))
    yield Cause.FORWARD_TIP, pushed(engine, (AHEAD_N, 0))
    yield Cause.BACKWARD_TIP, pushed(engine, (-AHEAD_N, 0))
    # a gait that changes its support too late to follow a push half as strong
    yield Cause.MISSED_SWITCH, pushed(engine, (0, 0.45 * SIDE_N), switch_min_phase=0.95)


def confusion(cases):
    """How often each built cause was found to be which."""
    table = Counter()
    for built, (scenes, fell) in cases:
        assert all(fell), built
        table.update((built, fall_cause(scene).cause) for scene in scenes)
    return table


@pytest.mark.parametrize(("world", "seeds"), [("sim", (1, 2)), ("real", (1,))])
def test_falls_on_built_ground_are_classified_right(world, seeds):
    n = len(seeds)
    assert confusion(walked(world, seeds)) == {
        (Cause.TRIP, Cause.TRIP): n,
        (Cause.SLIP, Cause.SLIP): n,
        (Cause.SIDEWAYS_TIP, Cause.SIDEWAYS_TIP): 1,
        (Cause.MOTOR_LIMIT, Cause.MOTOR_LIMIT): 1,
    }


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_falls_after_pushes_are_classified_right(engine):
    assert confusion(pushes(engine)) == {
        (Cause.SIDEWAYS_TIP, Cause.SIDEWAYS_TIP): 2,
        (Cause.FORWARD_TIP, Cause.FORWARD_TIP): 1,
        (Cause.BACKWARD_TIP, Cause.BACKWARD_TIP): 1,
        (Cause.MISSED_SWITCH, Cause.MISSED_SWITCH): 1,
    }


@pytest.fixture(scope="module", params=["start", "strider"])
def upright(request):
    """A walk that goes well."""
    gait = strider() if request.param == "strider" else gaits.get("start")
    (scene,), (fell,) = walk("sim", gait, flat(), limit_s=4.0)
    assert not fell
    return scene


@pytest.mark.parametrize(
    "event", [events.slip, events.trip, events.missed_switch, events.motor_limit]
)
def test_a_walk_that_goes_well_shows_no_cause(upright, event):
    signals = Signals(upright)
    assert event(signals, range(80, len(signals.time_s))) is None


def test_a_robot_that_does_not_lean_fell_for_unknown_reasons(upright):
    found = fall_cause(upright)
    assert (found.cause, found.time_s) == (Cause.UNKNOWN, None)


def test_physics_that_blew_up_is_no_robots_fault(upright):
    about = dataclasses.replace(upright.recording.metadata, end="diverged")
    recording = dataclasses.replace(upright.recording, metadata=about)
    scene = dataclasses.replace(upright, recording=recording)
    assert fall_cause(scene).cause == Cause.UNKNOWN


def test_the_cause_is_when_the_edge_is_met():
    begin_m = 0.3
    step = edge(leg_length_m(robots.get("nao")), begin_m)
    (scene,), _ = walk("sim", gaits.get("start"), step, limit_s=4.0)
    found = fall_cause(scene)
    signals = Signals(scene)
    tick = round(found.time_s / signals.tick_s)
    toes_m = signals.soles_m[tick, ..., 0].max()
    # the riser takes up the one cell behind the edge; toes are round, of 1 cm
    assert begin_m - 0.015 < toes_m < begin_m + 0.025 + 0.015
