"""Shapes of errors that are made up."""

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.residuals.mismatch_map import unexplained
from diagnosis.residuals.predictor import Channels, Predictor

NOISE_RAD = 4e-4
CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))


@pytest.fixture(scope="module")
def predictor():
    plant = arm()
    traces = [recorded(plant, duration_s=6.0, seed=seed) for seed in range(3)]
    return Predictor(plant, traces, CHANNELS)


def shape_of(predictor, law):
    """What is said of an error law(q, v, t) [rad] at the elbow."""
    residual = np.random.default_rng(0).standard_normal((len(predictor.scored) // 2, 2))
    residual[:, 1] += np.concatenate(
        [
            law(q, np.gradient(q, t.time_s), t.time_s) / NOISE_RAD
            for t in predictor.traces
            for q in [t.position_rad[:, 1]]
        ]
    )
    return unexplained(predictor, residual.ravel() * predictor.scored, 0.7)


def test_an_error_of_position_is_shown_over_position(predictor):
    found = shape_of(predictor, lambda q, v, t: 2e-3 * np.sin(9 * q))
    assert (found.channel, found.against) == ("position.elbow", "position.elbow")
    assert (found.share, found.unit, found.against_unit) == (0.7, "rad", "rad")
    wanted = 2e-3 * np.sin(9 * np.array(found.at))
    inner = slice(1, -1)  # the outermost bins are wide
    assert np.abs(np.array(found.mean) - wanted)[inner].max() < 3e-4
    assert np.ptp(wanted) > 3e-3


def test_an_error_of_velocity_is_shown_over_velocity(predictor):
    found = shape_of(predictor, lambda q, v, t: 2e-3 * np.sign(v))
    assert found.against == "velocity.elbow"
    assert found.against_unit == "rad/s"
    slow = np.abs(found.at) < 0.3
    wanted = 2e-3 * np.sign(found.at)
    assert np.abs(np.array(found.mean) - wanted)[~slow].max() < 3e-4


def test_a_drift_is_shown_over_time(predictor):
    found = shape_of(predictor, lambda q, v, t: 1e-3 * t)
    assert found.against == "time"
    slope = np.polynomial.Polynomial.fit(found.at, found.mean, 1).convert().coef[1]
    assert slope == pytest.approx(1e-3, rel=0.05)


def test_means_of_noise_are_within_their_spread(predictor):
    found = shape_of(predictor, lambda q, v, t: 0 * q)
    z = np.array(found.mean) / np.array(found.spread)
    assert np.sqrt(np.mean(z**2)) < 2.2  # the worst of four curves
    assert np.abs(z).max() > 0.5


def test_where_nothing_is_scored_there_is_no_shape():
    plant = arm()
    short = Predictor(plant, [recorded(plant, duration_s=0.3)], CHANNELS)
    assert unexplained(short, np.zeros(len(short.scored)), 1.0) is None
