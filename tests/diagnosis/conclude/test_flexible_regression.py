"""How far a regression gets with errors that are made up."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.conclude.flexible_regression import flexible_regression_errors
from diagnosis.residuals.predictor import Channels, Predictor

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
SEED = np.random.SeedSequence(0)


def nothing(trace):
    return 0.0


def nonlinear(trace):
    """Of the command; only at the elbow."""
    error = 5 * NOISE_RAD * np.sin(12 * trace.command_rad)
    return error * [0.0, 1.0]


def delayed(trace):
    """By three rows, about the longest that is remembered well."""
    past = np.roll(trace.command_rad, 3, axis=0)
    return 5 * NOISE_RAD * np.tanh(8 * past)


def chance(trace):
    """Large, but a new one each time."""
    random = np.random.default_rng(int(1e6 * abs(trace.command_rad[50, 0])))
    return 5 * NOISE_RAD * random.standard_normal(trace.position_rad.shape)


@cache
def nominal(seed):
    return recorded(arm(), noise_rad=NOISE_RAD, duration_s=5.0, seed=seed)


def predictor_of(error, seeds):
    traces = [
        replace(trace, position_rad=trace.position_rad + error(trace))
        for trace in map(nominal, seeds)
    ]
    predictor = Predictor(arm(), traces, CHANNELS, step_s=0.004)
    predictor.calibrate()
    return predictor


@cache
def before_and_after(error):
    learn, judge = predictor_of(error, (0, 1, 2)), predictor_of(error, (3,))
    residual = judge.residuals([()])[0].reshape(-1, 2)
    scored = judge.scored.reshape(-1, 2)
    before = [np.sqrt(np.mean(residual[scored[:, j], j] ** 2)) for j in range(2)]
    return np.array(before), flexible_regression_errors(learn, judge, SEED)


@pytest.mark.slow
@pytest.mark.parametrize("error", [nonlinear, delayed])
def test_what_can_be_known_is_found(error):
    before, after = before_and_after(error)
    assert before[1] > 2.5
    assert after[1] < 1 + 0.35 * (before[1] - 1)


@pytest.mark.slow
@pytest.mark.parametrize("error", [nothing, chance])
def test_noise_is_not(error):
    before, after = before_and_after(error)
    np.testing.assert_allclose(after, before, rtol=0.12)


def test_each_channel_is_on_its_own():
    before, after = before_and_after(nonlinear)
    assert after[0] == pytest.approx(before[0], rel=0.12)
    assert before[0] < 1.2


def test_commands_that_are_missing_and_data_that_are_few():
    """A missing command is the one before it; of few data nothing is learned."""
    gaps = nominal(0).command_rad.copy()
    gaps[60:64] = np.nan
    whole = Predictor(arm(), [replace(nominal(0), command_rad=gaps)], CHANNELS)
    assert np.isfinite(flexible_regression_errors(whole, whole, SEED)).all()
    few = Predictor(arm(), [nominal(0).part(0, 100)], CHANNELS)
    residual = few.residuals([()])[0].reshape(-1, 2)[few.scored.reshape(-1, 2)[:, 0]]
    wanted = np.sqrt(np.mean(residual**2, axis=0))
    np.testing.assert_allclose(flexible_regression_errors(few, few, SEED), wanted)


def test_simulations_that_diverge_leave_finite_errors(monkeypatch):
    """As of a passive pendulum with a healthy robot's spring; the others stay."""
    one = predictor_of(nothing, (0,))
    plain = one.predict([()])
    for wrong in (np.nan, np.inf, -1e300):
        values = plain.copy()
        values[0, 100:, 1] = wrong
        monkeypatch.setattr(one, "predict", lambda models, values=values: values)
        assert np.isfinite(flexible_regression_errors(one, one, SEED)).all()
