"""Bursts in residuals that are made up."""

import numpy as np
import pytest
from made_up_residuals import START_S, noise, pushed, time_of, two_traces

from diagnosis.residuals.bursts import (
    BIN_S,
    REACTION_S,
    bursts,
    push_intervals,
)


def bursts_of(*channel):
    return tuple(sorted(bursts(*channel)))


@pytest.fixture(scope="module")
def predictor():
    return two_traces()


def test_a_burst_is_found_where_it_is(predictor):
    residual = pushed(predictor, 7.0, 7.3)
    ((start_s, end_s),) = bursts(predictor, residual)
    assert start_s == pytest.approx(7.0, abs=BIN_S)
    assert end_s == pytest.approx(7.3, abs=BIN_S)
    assert bursts_of(predictor, residual, 1) == ((start_s, end_s),)
    assert bursts_of(predictor, residual, 0) == ()


def test_bursts_up_to_the_end_of_a_trace(predictor):
    ((start_s, end_s),) = bursts(predictor, pushed(predictor, 10.7, 12.0))
    assert start_s == pytest.approx(10.7, abs=BIN_S)
    assert end_s >= 11.0


def test_the_strongest_come_first_and_each_channel_is_in_order(predictor):
    residual = pushed(predictor, 9.0, 9.3, 40.0) + pushed(predictor, 7.0, 7.3)
    found = bursts(predictor, residual)
    assert [round(start_s) for start_s, _ in found] == [9, 7]
    starts = [start_s for start_s, _ in bursts_of(predictor, residual, 1)]
    assert starts == sorted(starts)


def test_noise_has_no_bursts(predictor):
    """Of one channel, with two or three values a bin, in fewer than one of fifty."""
    of_one = sum(
        len(bursts_of(predictor, noise(predictor, seed), channel))
        for seed in range(50)
        for channel in range(2)
    )
    assert of_one <= 4
    assert sum(len(bursts(predictor, noise(predictor, seed))) for seed in range(50)) < 3


def test_what_comes_back_with_every_motion_is_no_burst(predictor):
    wave = 10 * np.sin(9 * time_of(predictor)) * predictor.scored
    assert bursts(predictor, noise(predictor) + wave) == []
    everywhere = 5.0 * predictor.scored
    assert bursts(predictor, noise(predictor) + everywhere) == []


def test_pushes_may_last_or_begin_a_little_before_a_burst(predictor):
    always, short, own = push_intervals(predictor, pushed(predictor, 7.0, 7.3))
    assert always.start_s <= START_S
    assert always.start_s + always.duration_s > 11.0
    assert short.start_s == pytest.approx(7.0 - REACTION_S, abs=BIN_S)
    assert short.duration_s == pytest.approx(0.3, abs=2 * BIN_S)
    # it may have been in all recordings, or in this one only
    assert short.recording is None
    assert own == short._replace(recording=predictor.traces[1].recording)
    assert push_intervals(predictor, noise(predictor)) == [always]
