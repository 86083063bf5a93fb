"""Errors that come again whenever a joint does the same count as one sample."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.residuals.predictor import Predictor
from diagnosis.search.many import repeats
from diagnosis.search.many.ebic import Ebic
from diagnosis.search.many.repeats import _correlation, design_effect


@pytest.fixture(scope="module")
def predictor():
    return Predictor(arm(), [recorded(arm(), duration_s=20.0)])


def residual_of(predictor, repeated, seed=1):
    """White noise, and this share of the power that goes with angle and direction."""
    random = np.random.default_rng(seed)
    (trace,) = predictor.traces
    angle = trace.position_rad[trace.compared]
    forth = np.gradient(trace.position_rad, axis=0)[trace.compared] >= 0
    wave = np.sqrt(2) * np.sin(12 * angle) * np.where(forth, 1, -1)
    noise = random.standard_normal(angle.shape)
    left = np.sqrt(1 - repeated) * noise + np.sqrt(repeated) * wave
    return np.where(predictor.scored, left.reshape(-1), 0.0)


def test_the_correlation_is_that_of_an_analysis_of_variance():
    """Means of 4.0 between and 0.5 within: (4 - 0.5) / (4 + 0.5), with two of each."""
    left = np.array([1.0, 2.0, 3.0, 4.0])
    state, block = np.array([0, 0, 1, 1]), np.array([0, 1, 0, 1])
    ((correlation, samples),) = _correlation(left, state, block)
    assert correlation == pytest.approx(3.5 / 4.5)
    assert samples == 2


def test_rows_of_a_block_are_one_sample():
    left = np.array([0.0, 2.0, 2.0, 3.0, 4.0])
    state, block = np.array([0, 0, 0, 1, 1]), np.array([0, 0, 1, 0, 1])
    ((correlation, _),) = _correlation(left, state, block)
    assert correlation == pytest.approx(3.5 / 4.5)


def test_where_nothing_comes_again_there_is_no_correlation():
    rows = np.arange(4)
    assert _correlation(rows.astype(float), rows, rows) == []


def test_noise_does_not_come_again(predictor):
    for seed in range(3):
        effect = design_effect(predictor, residual_of(predictor, 0.0, seed))
        assert 1 <= effect < 1.3


def test_what_depends_on_angle_and_direction_comes_again(predictor):
    noise, half, most = (
        design_effect(predictor, residual_of(predictor, share))
        for share in (0.0, 0.5, 0.95)
    )
    assert most > half > 2 * noise


@pytest.mark.parametrize("parts", [6, 24])
def test_the_number_of_parts_hardly_matters(predictor, parts, monkeypatch):
    residual = residual_of(predictor, 0.5)
    usual = design_effect(predictor, residual)
    monkeypatch.setattr(repeats, "PARTS", parts)
    assert design_effect(predictor, residual) == pytest.approx(usual, rel=0.35)


def test_fewer_samples_count_where_repeats_do_not(predictor):
    residual = residual_of(predictor, 0.5)
    every, once = (
        Ebic.of(predictor, predictor, residual, repeats).samples
        for repeats in (True, False)
    )
    assert every / once == pytest.approx(design_effect(predictor, residual))


def test_missing_angles_are_left_out(predictor):
    residual = residual_of(predictor, 0.5)
    (trace,) = predictor.traces
    gaps = trace.position_rad.copy()
    gaps[100:150, 0] = np.nan
    some = Predictor(arm(), [replace(trace, position_rad=gaps)])
    left = np.where(some.scored, residual, 0.0)
    whole = design_effect(predictor, residual)
    assert design_effect(some, left) == pytest.approx(whole, rel=0.2)
