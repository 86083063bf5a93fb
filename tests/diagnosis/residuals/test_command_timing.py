"""Commands that jump early or late: of a simulated arm, and of drawn errors."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_traces import NOISE_RAD, arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.timing.clock import ClockNoise
from diagnosis.residuals.timing.command_timing import CommandTiming, jumps_of

NAMES = ("position.shoulder", "position.elbow")
LATE_S = 2e-3


def test_joints_whose_commands_jump_at_once_follow_one_jump():
    trace = recorded(arm(), duration_s=1.0)
    command = 0.01 * np.sin(trace.time_s)[:, None] * np.ones(2)
    command[20:, 0] += 0.3
    command[35:] -= 0.3
    jumping = replace(trace, command_rad=command)
    names = ("position.shoulder", "position.elbow", "gyroscope.x")
    found = jumps_of([trace, jumping], Channels(names, np.ones(3)))
    assert not found[: trace.ticks].any()
    wanted = np.zeros((jumping.ticks, 3), int)
    wanted[20:, 0] = 1
    wanted[35:, :2] = 2
    np.testing.assert_array_equal(found[trace.ticks :], wanted)


@pytest.mark.parametrize("clock", [None, ClockNoise(np.ones((90, 2)), 0.5, 0.7)])
def test_errors_of_jumps_are_whitened(clock):
    random = np.random.default_rng(0)
    changes = 5 * random.standard_normal((90, 2))
    jumps = np.repeat([0, 1, 2], 30)[:, None] * np.ones(2, int)
    timing = CommandTiming(changes, jumps, [60, 90], clock)
    late = random.standard_normal((3000, 3))
    late[:, 0] = 0
    white = random.standard_normal((3000, 90, 2))
    if clock is not None:
        own, row = (random.standard_normal((3000, 90, k)) for k in (2, 1))
        white = white + 0.5 * own + 0.7 * row
    wrong = white + np.take_along_axis(late[:, :, None], jumps[None], 1) * changes
    if clock is not None:
        wrong = clock.without(wrong)
    flat = timing.without(wrong).reshape(3000, -1)
    np.testing.assert_allclose(np.cov(flat.T), np.eye(180), atol=0.12)
    assert np.mean(wrong[:, 30:] ** 2) > 2
    assert 1.5 < timing.taken < 2.0
    (part,) = timing.part(slice(1, 2)).without(wrong[None, 0, 60:])
    np.testing.assert_allclose(part, timing.without(wrong[:1])[0, 60:])


def stepping(late_s, seed):
    """A recording whose command jumps once, `late_s` after its row says."""
    trace = recorded(arm(), duration_s=1.0, seed=seed)
    command = np.zeros((trace.ticks, 2))
    command[25:] = 0.3, -0.2
    stepped = replace(trace, command_rad=command, position_rad=0 * command)
    return replayed(stepped, late_s, seed)


def replayed(trace, late_s, seed):
    channels = Channels(NAMES, np.full(2, NOISE_RAD))
    predictor = Predictor(arm(), [trace], channels, step_s=2.5e-4)
    late = [] if not late_s else [latency(late_s)]
    (values,) = predictor.predict([tuple(late)])
    noise = np.random.default_rng(seed).standard_normal(values.shape)
    return replace(trace, name=f"{seed}", position_rad=values + NOISE_RAD * noise)


def latency(late_s):
    return PlacedEffect("command_latency", "commands", (late_s,))


def left(traces, jitter_s):
    channels = Channels(NAMES, np.full(2, NOISE_RAD), common_jitter_s=jitter_s)
    predictor = Predictor(arm(), traces, channels)
    predictor.calibrate(tolerances=False)
    (residual,) = predictor.residuals([()])
    return float(np.mean(residual[predictor.scored] ** 2))


def test_steps_of_a_jittering_clock_leave_noise():
    """Each is late by another time, as the whole motion that follows is."""
    late_s = np.abs(np.random.default_rng(1).normal(0, LATE_S, 6))
    traces = [stepping(late, seed) for seed, late in enumerate(late_s)]
    assert left(traces, 0.0) > 4
    assert left(traces, LATE_S) < 1.3
    exact = [stepping(0.0, seed) for seed in range(2)]
    assert left(exact, 0.0) == pytest.approx(1.0, abs=0.2)
