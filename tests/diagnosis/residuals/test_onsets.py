"""Moments from which on errors are large, in residuals that are made up."""

import numpy as np
import pytest
from made_up_residuals import noise, pushed, time_of, two_traces

from diagnosis.residuals.bursts import BIN_S, onsets, push_intervals
from diagnosis.residuals.replays import WARM_UP_S


@pytest.fixture(scope="module")
def predictor():
    return two_traces()


def test_it_is_found_in_its_recording(predictor):
    ((start_s, recording),) = onsets(predictor, pushed(predictor, 7.0, 99.0))
    assert start_s == pytest.approx(7.0, abs=BIN_S)
    assert recording == "trace 1"


def test_errors_that_grow_begin_where_they_begin(predictor):
    since_s = np.maximum(time_of(predictor) - 8.0, 0) * (predictor.trace == 0)
    ((start_s, recording),) = onsets(predictor, noise(predictor) + 50 * since_s)
    assert 8.0 <= start_s < 8.3
    assert recording == "trace 0"


def test_it_may_have_been_between_two_parts_of_a_recording(predictor):
    whole = predictor.traces[1]
    first, last = whole.part(0, 100), whole.part(180, whole.ticks)
    residual = pushed(predictor, 7.5, 99.0)[predictor.trace == 1].reshape(-1, 2)
    parts = type(predictor)(predictor.plant, [last, first], predictor.channels)
    own = np.concatenate([residual[180:], residual[:100]]).reshape(-1)
    (latest_s, _), (earliest_s, recording) = onsets(parts, own)
    assert latest_s == pytest.approx(last.time_s[0] + WARM_UP_S, abs=2 * BIN_S)
    assert earliest_s == pytest.approx(first.time_s[-1], abs=BIN_S)
    assert recording == "trace 1"


def test_noise_and_errors_that_were_always_there_begin_nowhere(predictor):
    wave = 10 * np.sin(9 * time_of(predictor)) * predictor.scored
    assert onsets(predictor, noise(predictor) + wave) == []
    assert not any(onsets(predictor, noise(predictor, seed)) for seed in range(50))


def test_what_began_is_tried_up_to_the_end(predictor):
    last_s = max(float(trace.time_s[-1]) for trace in predictor.traces)
    found = push_intervals(predictor, pushed(predictor, 7.0, 99.0))
    lasting = [one for one in found if 6.9 < one.start_s < 7.1]
    assert {one.recording for one in lasting} >= {None, "trace 1"}
    assert any(one.start_s + one.duration_s > last_s for one in lasting)
