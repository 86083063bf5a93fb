"""Faint pushes in residuals that are made up."""

import numpy as np
import pytest
from made_up_residuals import CHANNELS, noise, pushed, two_traces
from made_up_traces import arm, recorded

from diagnosis.residuals.bursts import WINDOWS_S, bursts, faint_pushes, push_intervals
from diagnosis.residuals.predictor import Predictor


@pytest.fixture(scope="module")
def predictor():
    return two_traces()


@pytest.mark.parametrize("window_s", WINDOWS_S)
def test_a_faint_push_is_found_where_it_is(predictor, window_s):
    rows = window_s / predictor.traces[1].tick_s
    faint = pushed(predictor, 7.0, 7.0 + window_s, 9.0 / np.sqrt(rows))
    (start_s, end_s), *_ = faint_pushes(predictor, faint)
    assert start_s == pytest.approx(7.0, abs=0.5 * window_s)
    assert end_s == pytest.approx(7.0 + window_s, abs=0.5 * window_s)


def test_energies_do_not_tell_it_but_its_length_is_tried(predictor):
    faint = pushed(predictor, 7.0, 7.5, 2.0)
    assert bursts(predictor, faint) == []
    _, *short = push_intervals(predictor, faint)
    starts = [one.start_s for one in short]
    durations = [one.duration_s for one in short]
    np.testing.assert_allclose(starts, 7.0, atol=0.3)
    assert max(durations) == pytest.approx(0.5, abs=0.03)


def test_noise_leans_nowhere(predictor):
    assert not any(
        faint_pushes(predictor, noise(predictor, seed)) for seed in range(100)
    )


def test_what_leans_all_the_time_leans_at_no_time(predictor):
    assert faint_pushes(predictor, noise(predictor) + 2.0 * predictor.scored) == []


def test_only_windows_that_fit_in_are_looked_at():
    """Of 0.45 s: one of 0.5 s does not, and most of 0.25 s hold the push."""
    trace = recorded(arm(), duration_s=0.45, seed=0)
    short = Predictor(arm(), [trace], CHANNELS)
    leaning = (trace.time_s >= 0.1) & (trace.time_s < 0.15)
    residual = np.column_stack([np.zeros(trace.ticks), 9.0 * leaning]).reshape(-1)
    ((start_s, end_s),) = faint_pushes(short, residual)
    assert start_s <= 0.11
    assert end_s - start_s == pytest.approx(0.1, abs=2 * trace.tick_s)
