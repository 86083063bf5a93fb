"""How much clocks jitter: of data whose jitter is drawn."""

import numpy as np
import pytest

from diagnosis.residuals.channels import Channels
from diagnosis.residuals.timing.jitter import with_clock, with_shared_clock

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


def far_off(common_s):
    """Noise, a slow error of the model, fast ones of each joint, and jitter."""
    random = np.random.default_rng(5)
    white, _ = errors(0.0, common_s, 0.6)
    fast = 3e-3 * SPEED * np.sign(np.sin(40 * TIME_S[:, None] + np.arange(C)))
    slow = 50 * np.sin(6 * TIME_S[:, None] + random.uniform(0, 6, C))
    return white + fast + slow


def test_a_jitter_of_whole_rows_shows_however_far_off_the_model_is():
    found = with_shared_clock(CHANNELS, far_off(1e-3), SPEED, EVERY)
    assert found.common_jitter_s == pytest.approx(1e-3, rel=0.25)
    assert found.own_jitter_s == 0
    assert (found.noise <= 1).all()


def test_errors_that_joints_do_not_share_are_no_jitter():
    assert with_shared_clock(CHANNELS, far_off(0.0), SPEED, EVERY) == CHANNELS


def test_noise_is_that_of_slow_rows():
    white, _ = errors(0.0, 1e-3, 0.6)
    found = with_shared_clock(CHANNELS, white, SPEED, EVERY)
    np.testing.assert_allclose(found.noise, 0.6, rtol=0.25)
    assert found.common_jitter_s == pytest.approx(1e-3, rel=0.1)
