import numpy as np
import pytest

from walk_engine.time_profiles import (
    linear_step,
    parabolic_return,
    parabolic_step,
    warped_phase,
)

DENSE = np.linspace(0.0, 1.0, 4001)


def test_linear_step():
    time_s = np.array([-0.1, 0.0, 0.1, 0.2, 0.3])
    assert np.allclose(linear_step(time_s, 0.2), [0, 0, 0.5, 1, 1])


@pytest.mark.parametrize("period", [0.2, 1.0])
def test_parabolic_step_without_dead_time(period):
    part = np.array([-1.0, 0.0, 0.25, 0.5, 0.75, 1.0, 2.0])
    expected = [0, 0, 0.125, 0.5, 0.875, 1, 1]
    assert np.allclose(parabolic_step(part * period, period), expected)


def test_parabolic_step_rests_in_half_the_dead_time_at_each_end():
    time_s = np.array([0.0, 0.25, 0.375, 0.5, 0.625, 0.75, 1.0])
    expected = [0, 0, 0.125, 0.5, 0.875, 1, 1]
    assert np.allclose(parabolic_step(time_s, 1.0, 0.5), expected)


def test_parabolic_step_has_constant_acceleration_of_either_sign():
    acceleration = np.diff(parabolic_step(DENSE, 1.0), 2) / np.diff(DENSE)[0] ** 2
    assert np.allclose(acceleration[:1990], 4.0, atol=1e-6)
    assert np.allclose(acceleration[2010:], -4.0, atol=1e-6)


@pytest.mark.parametrize(
    ("phase", "expected"),
    [
        *((0, 0), (0.125, 0.125), (0.25, 0.5), (0.375, 0.875), (0.5, 1)),
        *((0.625, 0.875), (0.75, 0.5), (0.875, 0.125), (1, 0), (1.5, 0), (-0.5, 0)),
    ],
)
def test_parabolic_return(phase, expected):
    assert parabolic_return(np.array(phase)) == pytest.approx(expected)


@pytest.mark.parametrize("apex", [0.3, 0.5, 0.7])
def test_warping_moves_the_apex_and_keeps_the_ends_smooth(apex):
    height = parabolic_return(warped_phase(DENSE, apex))
    assert DENSE[np.argmax(height)] == pytest.approx(apex, abs=1e-3)
    assert height[0] == height[-1] == 0
    speed = np.diff(height) / np.diff(DENSE)[0]
    assert abs(speed[0]) < 0.05
    assert abs(speed[-1]) < 0.05
    assert np.abs(np.diff(speed)).max() < 16 * (0.5 / 0.3) ** 2 / 4000 + 1e-6


def test_warping_by_one_half_changes_nothing():
    assert np.allclose(warped_phase(DENSE, 0.5), DENSE, atol=1e-15)


def test_arrays_of_periods_are_taken_one_by_one():
    time_s, period_s = np.array([0.1, 0.1]), np.array([0.2, 0.4])
    assert np.allclose(parabolic_step(time_s, period_s), [0.5, 0.125])
    assert np.allclose(linear_step(time_s, period_s), [0.5, 0.25])
