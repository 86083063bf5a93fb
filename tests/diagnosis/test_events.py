"""A motor that switches off, in one recording of several: found in time and by name."""

from dataclasses import replace

import numpy as np
import pytest
from joint_rigs import (
    ARM,
    arm_law,
    exact,
    integrated,
    plant_of,
    run_from,
    ticks,
    trace_of,
)
from known_arms import LEAN, NOISE_RAD
from made_up_traces import GAINS, arm_command

from diagnosis.effects.parts import PlacedEffect
from diagnosis.pipeline import diagnose
from diagnosis.residuals.predictor import Predictor
from diagnosis.traces.split import split

DAMPING = 0.3
OFF_S = 2.7
PLANT = plant_of(
    ARM.replace('axis="0 -1 0"/>', f'axis="0 -1 0" damping="{DAMPING}"/>'), **GAINS
)


def recording(name, seed, off=None, duration_s=5.0):
    """A trace whose motor `off` (joint, start, end) has no torque for a while."""
    time_s = ticks(duration_s, 0.02)
    command = arm_command(time_s, seed)

    def torque_nm(t, q, v, k):
        on = np.ones(2)
        if off is not None and off[1] <= t < off[2]:
            on[off[0]] = 0.0
        return on * (GAINS["kp"] * (command[k] - q) - GAINS["kd"] * v) - DAMPING * v

    truth = integrated(arm_law(torque_nm), time_s, np.zeros(4))[:, :2]
    noise = NOISE_RAD * np.random.default_rng(seed + 1000).standard_normal(truth.shape)
    trace = trace_of(PLANT, time_s, truth + noise, command_rad=command)
    return replace(trace, name=name), truth


@pytest.mark.parametrize("end_s", [1.5, 99.0])
def test_a_motor_that_is_off_is_as_the_equations_of_motion_say(end_s):
    trace, truth = recording("off", 0, (1, 1.02, end_s), duration_s=2.0)
    effect = ("servo_off", "elbow", 1.0, 1.02, end_s - 1.02)
    np.testing.assert_allclose(exact(PLANT, run_from(trace), effect), truth, atol=2e-3)
    always_on = exact(PLANT, run_from(trace))
    assert np.abs(always_on - truth).max() > 0.1


def test_an_effect_in_one_recording_leaves_the_others_as_they_are():
    traces = [
        recording(name, seed, duration_s=1.0)[0] for seed, name in enumerate("ab")
    ]
    predictor = Predictor(PLANT, traces)
    load = PlacedEffect("payload_mass", "lower", (0.2,))
    here, there, all_, none = predictor.predict(
        [(replace(load, recording="a"),), (replace(load, recording="b"),), (load,), ()]
    )
    rows = traces[0].ticks
    np.testing.assert_array_equal(here[:rows], all_[:rows])
    np.testing.assert_array_equal(here[rows:], none[rows:])
    np.testing.assert_array_equal(there[rows:], all_[rows:])
    assert np.abs(all_ - none).max() > 1e-3


def test_recordings_are_cut_such_that_what_is_fitted_shows_the_event():
    traces = [recording(name, seed)[0] for seed, name in enumerate("abc")]
    errors = [np.ones(trace.ticks) for trace in traces]
    errors[1][traces[1].time_s > OFF_S] = 100.0
    whole, cut = split(traces), split(traces, errors)
    assert {trace.name for trace in whole.fit} <= set("abc")

    def shown(parts):
        return any(
            part.recording == "b" and part.time_s[-1] > OFF_S + 0.5 for part in parts
        )

    assert shown(cut.fit)
    assert shown(cut.test) or shown(cut.select)


@pytest.mark.slow
def test_it_is_found_in_the_recording_in_which_it_was():
    traces = [
        recording(name, seed, (1, OFF_S, 99.0) if name == "b" else None)[0]
        for seed, name in enumerate("abc")
    ]
    verdict = diagnose(PLANT, traces, np.random.SeedSequence(0), LEAN).verdict
    assert verdict.kind == "effects"
    (found,) = verdict.effects
    assert (found.name, found.place) == ("servo_off", "elbow")
    assert found.parameters["share"].value == pytest.approx(1.0, abs=0.02)
    assert found.when.kind == "burst"
    assert found.when.start_s == pytest.approx(OFF_S, abs=0.05)
    assert found.when.recording == "b"
