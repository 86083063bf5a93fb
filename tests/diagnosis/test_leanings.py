"""Faint pushes in residuals that are made up."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.bursts import bursts, push_intervals
from diagnosis.leanings import WINDOWS_S, leanings
from diagnosis.predictor import Channels, Predictor

CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, 4e-4))
START_S = 5.0


@pytest.fixture(scope="module")
def predictor():
    """Two traces of six seconds, on clocks that do not begin at 0."""
    plant = arm()
    traces = [recorded(plant, duration_s=6.0, seed=seed) for seed in range(2)]
    traces = [replace(trace, time_s=trace.time_s + START_S) for trace in traces]
    return Predictor(plant, traces, CHANNELS)


def noise(predictor, seed=0):
    random = np.random.default_rng(seed)
    return predictor.scored * random.standard_normal(len(predictor.scored))


def leaning(predictor, first_s, last_s, size):
    """In the second trace's second channel."""
    time_s = np.concatenate([np.repeat(t.time_s, 2) for t in predictor.traces])
    rows = (predictor.trace == 1) & (predictor.channel == 1)
    rows &= (time_s >= first_s) & (time_s < last_s)
    return noise(predictor) + size * rows * predictor.scored


@pytest.mark.parametrize("window_s", WINDOWS_S)
def test_a_faint_push_is_found_where_it_is(predictor, window_s):
    rows = window_s / predictor.traces[1].tick_s
    pushed = leaning(predictor, 7.0, 7.0 + window_s, 9.0 / np.sqrt(rows))
    (start_s, end_s), *_ = leanings(predictor, pushed)
    assert start_s == pytest.approx(7.0, abs=0.5 * window_s)
    assert end_s == pytest.approx(7.0 + window_s, abs=0.5 * window_s)


def test_energies_do_not_tell_it_but_its_length_is_tried(predictor):
    pushed = leaning(predictor, 7.0, 7.5, 2.0)
    assert bursts(predictor, pushed) == []
    _, *short = push_intervals(predictor, pushed)
    starts, durations = np.transpose(short)
    np.testing.assert_allclose(starts, 7.0, atol=0.3)
    assert max(durations) == pytest.approx(0.5, abs=0.03)


def test_noise_leans_nowhere(predictor):
    assert not any(leanings(predictor, noise(predictor, seed)) for seed in range(100))


def test_what_leans_all_the_time_leans_at_no_time(predictor):
    assert leanings(predictor, noise(predictor) + 2.0 * predictor.scored) == []


def test_what_is_shorter_than_a_window_has_none():
    plant = arm()
    short = Predictor(plant, [recorded(plant, duration_s=0.3, seed=0)], CHANNELS)
    ends = [end - start for start, end in leanings(short, 50.0 * noise(short))]
    assert all(seconds < 0.3 for seconds in ends)
