"""Starts that are not known: what they change is not held against a model."""

import numpy as np
import pytest
from joint_rigs import ARM, arm_law, integrated, plant_of, ticks, trace_of
from made_up_traces import arm, arm_command, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.residuals.start_state import StartUncertainty
from diagnosis.residuals.timing.clock import ClockNoise
from diagnosis.traces.windows import Run

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
KP, KD = 8.0, 0.2


def in_motion(seed):
    """A recording of servos with little damping that begins while the arm moves."""
    plant = plant_of(ARM, kp=KP, kd=KD)
    time_s = ticks(4.0, 0.02)
    command = arm_command(time_s, seed)
    law = arm_law(lambda t, q, v, k: KP * (command[k] - q) - KD * v)
    truth = integrated(law, time_s, [0, 0, 0, 0])
    moving = slice(50, None)
    noise = np.random.default_rng(seed).standard_normal(truth[:, :2].shape)
    measured = (truth[:, :2] + NOISE_RAD * noise)[moving]
    trace = trace_of(plant, time_s[moving], measured, command_rad=command[moving])
    return Predictor(plant, [trace], CHANNELS), truth[50, 2:]


def rms(predictor, *model):
    residual = predictor.residuals([model])[0]
    return float(np.sqrt(np.mean(residual[predictor.scored] ** 2)))


@pytest.mark.parametrize("seed", [0, 1])
def test_a_right_model_leaves_noise_though_its_start_is_wrong(seed):
    predictor, truth = in_motion(seed)
    start = Run.of(predictor.traces[0]).velocity_rad_s
    assert np.abs(start - truth).max() > 0.05
    assert rms(predictor) > 2
    predictor.calibrate()
    predictor = predictor.nominal()
    assert rms(predictor) == pytest.approx(1, abs=0.15)
    for wrong in (
        PlacedEffect("servo_gain", "elbow", (0.95,)),
        PlacedEffect("coulomb_friction", "elbow", (0.02,)),
        PlacedEffect("command_latency", "commands", (0.005,)),
    ):
        assert rms(predictor, wrong) > 2


def test_parts_of_a_predictor_know_the_starts_of_theirs():
    plant = arm()
    traces = [recorded(plant, duration_s=1.5, seed=seed) for seed in range(3)]
    whole = Predictor(plant, traces, CHANNELS)
    whole.calibrate()
    whole = whole.nominal()  # these are shared by all traces
    rows = whole.trace >= 1
    part = whole.part(1, 3).residuals([()])[0]
    np.testing.assert_allclose(part, whole.residuals([()])[0][rows], atol=1e-6)


def signatures(rows=40):
    """Two of one run and one channel: a decay and an oscillation."""
    t = np.linspace(0, 1, rows)[:, None]
    return 30 * np.exp(-5 * t), 20 * np.exp(-2 * t) * np.sin(20 * t)


def test_what_looks_like_a_wrong_start_is_taken_out():
    """Of a s whitening leaves a s / sqrt(1 + s.s): its square is the likelihood."""
    decay, _ = signatures()
    doubt = StartUncertainty(np.stack([decay, np.zeros_like(decay)]), [len(decay)])
    left = doubt.without(0.7 * decay[None])[0]
    np.testing.assert_allclose(left, 0.7 * decay / np.sqrt(1 + np.sum(decay**2)))


def test_two_wrong_starts_at_once():
    decay, wave = signatures()
    doubt = StartUncertainty(np.stack([decay, wave]), [len(decay)])
    wrong = 0.5 * decay - 0.8 * wave
    left = doubt.without(wrong[None])[0]
    both = np.hstack([decay, wave])
    weakest = np.linalg.eigvalsh(both.T @ both)[0]
    assert np.linalg.norm(left) < np.linalg.norm(wrong) / np.sqrt(1 + weakest)


def test_what_starts_do_not_change_stays():
    decay, wave = signatures()
    doubt = StartUncertainty(np.stack([decay, wave]), [len(decay)])
    basis, _ = np.linalg.qr(np.hstack([decay, wave]))
    other = np.random.default_rng(0).standard_normal(decay.shape)
    other -= basis @ (basis.T @ other)
    np.testing.assert_allclose(doubt.without(other[None])[0], other, atol=1e-9)


def test_a_start_is_not_wrong_by_any_amount():
    """A signature weaker than the noise explains next to nothing."""
    decay, _ = signatures()
    weak = 1e-3 * decay
    doubt = StartUncertainty(np.stack([weak, np.zeros_like(weak)]), [len(weak)])
    np.testing.assert_allclose(doubt.without(decay[None])[0], decay, rtol=0.02)


def test_windows_have_starts_of_their_own():
    decay, wave = signatures()
    silent, rows = np.zeros_like(decay), len(decay)
    # window 0 depends on the start of one joint, which moves two; window 1 on none
    position = np.vstack([np.hstack([decay, wave]), np.hstack([silent, silent])])
    doubt = StartUncertainty(position[None], [rows, 2 * rows])
    residual = np.vstack([np.hstack([decay, wave])] * 2)[None]
    left = doubt.without(residual)[0]
    assert np.abs(left[:rows]).max() < 0.02 * decay.max()
    np.testing.assert_array_equal(left[rows:], residual[0, rows:])
    alone = doubt.part(0, 1).without(residual[:, :rows])[0]
    np.testing.assert_allclose(alone, left[:rows])
    against = np.vstack([np.hstack([decay, -wave])] * 2)[None]
    assert np.abs(doubt.without(against)[0][:rows]).max() > 0.5 * decay.max()


def test_errors_of_a_clock_are_whitened_before_those_of_a_start():
    """Without the clock the same start is taken out of errors as they are."""
    random = np.random.default_rng(4)
    changes, speed = 40 * random.standard_normal((2, 60, 2)), np.zeros((60, 2))
    speed[:30] = 3000.0
    clock = ClockNoise(speed, 5e-4, 3e-4)
    start = StartUncertainty(changes, [40, 60], clock.without)
    wrong = changes[:1] + 0.0 * changes[1:]
    timed = start.without(clock.without(wrong))
    assert np.abs(timed).max() < 0.1 * np.abs(clock.without(wrong)).max()
    evenly = start.evenly().without(wrong)
    assert np.abs(evenly).max() < 0.1 * np.abs(wrong).max()
    later = start.part(1, 2)
    np.testing.assert_allclose(later.evenly().without(wrong[:, 40:]), evenly[:, 40:])
