"""Steps that MuJoCo takes by itself lead where steps lead that are taken one by one."""

import numpy as np
import pytest
from joint_rigs import run_from, ticks, trace_of
from made_up_traces import arm, arm_command

from diagnosis.effects.library import all_effects
from diagnosis.effects.parts import PlacedEffect
from diagnosis.replay import rolling
from diagnosis.replay.replay import replay
from diagnosis.replay.rolling import Rolling
from diagnosis.residuals.replays import variants_of

STEP_S = 0.001


def run_of(plant, late_s=0.0, height=1.0, duration_s=1.5, tick_s=0.01, **more):
    time_s = ticks(duration_s, tick_s)
    command = height * arm_command(time_s)
    if late_s:  # stands still, then jumps
        command = np.where(time_s[:, None] > late_s, 0.8, 0.0) * np.ones((1, 2))
    return run_from(trace_of(plant, time_s, command_rad=command, **more))


def placed(name, place, *values):
    return PlacedEffect(name, place, values)


MODELS = [
    (),
    (placed("payload_mass", "lower", 0.1), placed("viscous_friction", "elbow", 0.2)),
    (placed("coulomb_friction", "shoulder", 0.1), placed("servo_gain", "elbow", 0.7)),
    (
        placed("encoder_offset", "elbow", 0.05),
        placed("command_latency", "commands", 0.03),
    ),
]


def both_ways(monkeypatch, run, models, plant):
    """What replays say, how many blocks were rolled, and what single steps say."""
    count = []

    def counted(self, *args):
        found = taken(self, *args)
        count.append(found is not None)
        return found

    taken = Rolling.taken
    with monkeypatch.context() as patch:
        patch.setattr(Rolling, "taken", counted)
        (rolled,) = replay([run], variants_of(plant, models), STEP_S)
    with monkeypatch.context() as patch:
        patch.setattr(Rolling, "waits", lambda self: True)
        (stepped,) = replay([run], variants_of(plant, models), STEP_S)
    return rolled, count, stepped


def assert_same(one, other):
    for name in ("position_rad", "velocity_rad_s", "servo_nm"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_the_same_bits(monkeypatch):
    rolled, count, stepped = both_ways(monkeypatch, run_of(arm()), MODELS, arm())
    assert count
    assert all(count)
    assert_same(rolled, stepped)


@pytest.mark.parametrize("limit", [0.6, 0.05])
def test_where_servos_saturate_each_step_is_taken(monkeypatch, limit):
    plant = arm(limit=limit)
    rolled, count, stepped = both_ways(monkeypatch, run_of(plant), MODELS, plant)
    assert not all(count)
    assert any(count)
    assert_same(rolled, stepped)


def test_where_a_command_jumps_a_step_is_taken(monkeypatch):
    plant, run = arm(limit=8.0), run_of(arm(limit=8.0), late_s=0.5)
    rolled, count, stepped = both_ways(monkeypatch, run, MODELS[:1], plant)
    assert any(count)
    assert_same(rolled, stepped)
    assert rolled.position_rad[0, -1] == pytest.approx(0.8, abs=0.3)


TYPICAL = [
    placed(name, place, *(one.typical for one in kind.parameters(arm(), place)))
    for name, kind in all_effects().items()
    for place in kind.places(arm(), [])[-1:]
]


@pytest.mark.parametrize("effect", TYPICAL, ids=lambda one: one.name)
def test_every_effect_acts_alike(monkeypatch, effect):
    """A law that is needed at each step and left out would leave the motion as is."""
    ways = both_ways(monkeypatch, run_of(arm()), [(effect,)], arm())
    assert_same(ways[0], ways[2])


def test_effects_that_need_a_law_at_each_step_are_known():
    slow = placed("backlash", "elbow", 0.02)
    assert variants_of(arm(), [(), (slow,)]).need_laws().tolist() == [False, True]


def test_as_pushes_begin_and_end_a_step_is_taken(monkeypatch):
    push = placed("external_force", "lower", 2.0, 0.0, 0.0, 0.4003, 0.3)
    steady = placed("external_force", "lower", 1.0, 0.0, 0.0, -1.0, 100.0)
    run = run_of(arm())
    rolled, count, stepped = both_ways(monkeypatch, run, [(push,), (steady,)], arm())
    assert all(count)
    assert_same(rolled, stepped)
    assert np.ptp(rolled.position_rad[0, 60:80] - rolled.position_rad[1, 60:80]) > 1e-3


def test_torques_without_servos(monkeypatch):
    plant, time_s = arm(kp=0.0, kd=0.5), ticks(1.0, 0.01)
    trace = trace_of(plant, time_s, torque_nm=0.2 * arm_command(time_s))
    run = run_from(trace)
    rolled, count, stepped = both_ways(monkeypatch, run, MODELS[:3], plant)
    assert all(count)
    assert_same(rolled, stepped)
    assert np.ptp(rolled.position_rad) > 0.01


def test_what_blows_up_blows_up_in_single_steps(monkeypatch):
    plant = arm(kp=1e7, kd=0.0)  # too stiff for its steps
    rolled, count, stepped = both_ways(monkeypatch, run_of(plant), [()], plant)
    assert not all(count)
    assert_same(rolled, stepped)
    assert np.isnan(rolled.position_rad).any()


def test_after_each_failure_it_waits_twice_as_long(monkeypatch):
    plant = arm(limit=0.05)
    waits = []
    taken = Rolling.taken

    def counted(self, *args):
        found = taken(self, *args)
        waits.append(self._wait)
        return found

    monkeypatch.setattr(Rolling, "taken", counted)
    replay([run_of(plant, duration_s=3.0)], variants_of(plant, [()]), STEP_S)
    assert [one for one in waits if one][:2] == [rolling.PAUSE, 2 * rolling.PAUSE]
