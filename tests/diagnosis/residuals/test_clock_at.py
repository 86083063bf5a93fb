"""Noise and jitter that a model leaves, and whether a diagnosis measures them anew."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis import learned
from diagnosis.effects.parts import PlacedEffect
from diagnosis.learned import Learned
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.timing.clock_at import clock_at

NOISE_RAD, JITTER_S = 4e-4, 2e-4
STOP = ("end_stop", "elbow", 0.3, 1.0)
MODEL = (PlacedEffect("end_stop", "elbow", (0.3, 1.0)),)


@pytest.fixture(scope="module")
def trace():
    """Of an arm with an end stop, whose rows are early or late."""
    exact = recorded(arm(), STOP, duration_s=8.0, noise_rad=0.0, tick_s=0.01)
    random = np.random.default_rng(3)
    late_s = JITTER_S * random.standard_normal((exact.ticks, 1))
    speed = np.gradient(exact.position_rad, exact.time_s, axis=0)
    noise = NOISE_RAD * random.standard_normal(speed.shape)
    return replace(exact, position_rad=exact.position_rad + speed * late_s + noise)


@pytest.fixture(scope="module")
def mixed(trace):
    """Noise that includes what jitter adds on average."""
    speed = np.gradient(trace.position_rad, trace.time_s, axis=0)
    added = JITTER_S * np.sqrt(np.mean(speed**2, axis=0))
    names = "position.shoulder", "position.elbow"
    return Channels(names, np.hypot(NOISE_RAD, added))


def calibrated(trace, channels, model):
    predictor = Predictor(arm(), [trace], channels, step_s=0.004)
    predictor.calibrate(model)
    return predictor


def test_the_right_model_shows_noise_and_jitter(trace, mixed):
    found, is_far_off = clock_at(calibrated(trace, mixed, MODEL), MODEL, mixed)
    assert not is_far_off
    np.testing.assert_allclose(found.noise, NOISE_RAD, rtol=0.1)
    assert found.jitter_s == pytest.approx(JITTER_S, rel=0.15)
    np.testing.assert_array_equal(found.floor, mixed.floor)


def test_a_model_without_the_stop_does_not(trace, mixed):
    found, is_far_off = clock_at(calibrated(trace, mixed, ()), (), mixed)
    assert is_far_off
    assert (found.noise > 1.2 * NOISE_RAD).all()


def anew(predictor, model, noise=None):
    """The channels that a diagnosis measures at its best model; None if as before."""
    winner = SimpleNamespace(model=model) if model else None
    found = SimpleNamespace(
        search=SimpleNamespace(judge=SimpleNamespace(fit=predictor)),
        result=SimpleNamespace(winner=winner),
        noise=noise,
    )
    return Learned._timed_anew(found)


@pytest.mark.slow
@pytest.mark.parametrize("other", [1.05, 1.1, 1.2])
def test_noise_is_measured_anew_where_it_is_another(trace, mixed, other, monkeypatch):
    monkeypatch.setattr(learned, "OTHER_NOISE", other)
    wrong = calibrated(trace, mixed, MODEL)
    found = anew(wrong, MODEL)
    assert found is not None
    np.testing.assert_allclose(found.noise, NOISE_RAD, rtol=0.1)
    right = calibrated(trace, found, MODEL)
    assert anew(right, MODEL) is None
    assert anew(wrong, ()) is None  # nothing was found
    assert anew(wrong, MODEL, noise="of the healthy robot") is None


def test_channels_without_their_clock_are_as_before(mixed):
    timed = mixed.jittering(np.array([0.5, 0.8]), 1e-3, 2e-3)
    assert timed.untimed.jitter_s == 0
    np.testing.assert_allclose(timed.untimed.noise, mixed.noise)
    np.testing.assert_array_equal(timed.untimed.floor, mixed.floor)
