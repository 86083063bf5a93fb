"""The jitter of clocks: of data whose jitter is drawn."""

import numpy as np
import pytest
from made_up_traces import arm, trace_of

from diagnosis.residuals.channels import Channels
from diagnosis.residuals.timing.clock import ClockNoise, clock_noise, speeds

ROWS, C = 4000, 5
TIME_S = np.arange(ROWS) / 100
SPEED = 2000 * np.sin(TIME_S[:, None] * np.array([0.7, 1.1, 1.9, 2.3, 3.1]))


def test_whitened_errors_are_alike_at_all_speeds_and_independent():
    random = np.random.default_rng(0)
    own, common = (random.standard_normal((ROWS, k)) for k in (C, 1))
    white = random.standard_normal((ROWS, C)) + SPEED * (3e-4 * own + 6e-4 * common)
    (found,) = ClockNoise(SPEED, 3e-4, 6e-4).without(white[None])
    np.testing.assert_allclose(np.cov(found.T), np.eye(C), atol=0.1)
    fast = np.abs(SPEED).sum(axis=1) > 7000
    assert np.mean(found[fast] ** 2) == pytest.approx(1.0, abs=0.1)
    assert np.mean(white[fast] ** 2) > 1.5


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
