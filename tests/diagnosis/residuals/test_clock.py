"""The jitter of clocks: of data whose jitter is drawn."""

import numpy as np
import pytest
from made_up_traces import arm, trace_of

from diagnosis.residuals.channels import Channels
from diagnosis.residuals.clock import ClockNoise, clock_noise, speeds, with_clock

ROWS, C = 4000, 5
TIME_S = np.arange(ROWS) / 100
SPEED = 2000 * np.sin(TIME_S[:, None] * np.array([0.7, 1.1, 1.9, 2.3, 3.1]))
CHANNELS = Channels(tuple(f"position.{name}" for name in "abcde"), np.ones(C))
EVERY = np.ones((ROWS, C), bool)


def errors(own_s, common_s, noise):
    """Sensor noise and what jitter makes of motion, beside a smooth model error."""
    random = np.random.default_rng(0)
    own, common = (random.standard_normal((ROWS, k)) for k in (C, 1))
    smooth = 2 * np.sin(6 * TIME_S[:, None])
    white = noise * random.standard_normal((ROWS, C))
    return white + SPEED * (own_s * own + common_s * common), smooth


@pytest.mark.parametrize(
    ("own_s", "common_s", "noise"),
    [(0.0, 1e-3, 0.7), (5e-4, 0.0, 0.8), (3e-4, 6e-4, 0.55), (0.0, 0.0, 1.0)],
)
def test_noise_and_both_kinds_of_jitter_are_told_apart(own_s, common_s, noise):
    white, smooth = errors(own_s, common_s, noise)
    found = with_clock(CHANNELS, white + smooth, SPEED, EVERY)
    assert found.own_jitter_s == pytest.approx(own_s, abs=1.2e-4)
    assert found.common_jitter_s == pytest.approx(common_s, abs=1.2e-4)
    np.testing.assert_allclose(found.noise, noise, rtol=0.15)
    np.testing.assert_allclose(found.wider, 1.0)
    np.testing.assert_array_equal(found.floor, CHANNELS.noise)


def test_whitened_errors_are_alike_at_all_speeds_and_independent():
    white, _ = errors(3e-4, 6e-4, 1.0)
    (found,) = ClockNoise(SPEED, 3e-4, 6e-4).without(white[None])
    np.testing.assert_allclose(np.cov(found.T), np.eye(C), atol=0.1)
    fast = np.abs(SPEED).sum(axis=1) > 7000
    assert np.mean(found[fast] ** 2) == pytest.approx(1.0, abs=0.1)
    assert np.mean(white[fast] ** 2) > 1.5


def test_rows_that_do_not_count_tell_nothing():
    white, smooth = errors(5e-4, 0.0, 0.8)
    wrong = white + smooth
    wrong[1000:1100] = 1e4
    there = EVERY.copy()
    there[1000:1100] = False
    found = with_clock(CHANNELS, wrong, SPEED, there)
    assert found.own_jitter_s == pytest.approx(5e-4, abs=1.2e-4)


def test_a_push_is_no_jitter():
    """It jumps in a few rows, of all joints; the least squares alone would take it."""
    white, smooth = errors(0.0, 0.0, 1.0)
    wrong = white + smooth
    wrong[1000:1030] += 300.0
    found = with_clock(CHANNELS, wrong, SPEED, EVERY)
    most_s = (found.own_jitter_s**2 + found.common_jitter_s**2) ** 0.5
    assert most_s * np.sqrt(np.mean(SPEED**2)) < 1.2


def test_speeds_are_those_of_positions_in_units_of_noise():
    time_s = np.arange(200) / 100
    position = np.stack([0.3 * time_s, np.sin(time_s)], axis=1)
    trace = trace_of(arm(), time_s, position)
    names = ("position.shoulder", "position.elbow", "gyroscope.x")
    channels = Channels(names, np.array([0.1, 0.5, 1.0]))
    found = speeds([trace], channels)[5:-5]
    np.testing.assert_allclose(found[:, 0], 3.0, rtol=1e-6)
    np.testing.assert_allclose(found[:, 1], 2 * np.cos(time_s[5:-5]), atol=1e-3)
    assert not found[:, 2].any()
    assert clock_noise([trace], channels, np.ones((200, 3), bool)) is None
