"""Intervals of 80 %: they must hold the truth in 80 of 100 diagnoses."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_up_traces import arm
from scipy.stats import binom

from diagnosis.conclude import recordings_alone as module
from diagnosis.conclude.estimates import (
    Z_80,
    estimates,
    spread_of_recordings,
    standard_errors,
)
from diagnosis.conclude.recordings_alone import errors_between_recordings, said_alone
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.coordinates import STEP, Coordinates
from diagnosis.search.fitting import FittedModel

BLOCKS, ROWS, RECORDINGS = 60, 25, 4
DIAGNOSES = 40
KEYS = ("encoder_offset", "elbow"), ("joint_spring", "shoulder")
PLANT = arm()


def toy(seed, common):
    """A linear fit of an offset and a spring; their true coordinates are 0.

    Args:
      seed: of the noise.
      common: part of the noise's variance that a block has in common.
    """
    spring = PlacedEffect("joint_spring", "shoulder", (0.0, 0.0))
    coordinates = Coordinates(
        PLANT, (PlacedEffect("encoder_offset", "elbow", (0,)), spring)
    )
    t = np.arange(BLOCKS * ROWS) / ROWS
    slow = np.sin(0.9 * t), np.sin(0.31 * t + 1), np.cos(0.17 * t)
    jacobian = 0.1 * np.stack(slow, axis=1)
    random = np.random.default_rng(seed)
    noise = np.sqrt(1 - common) * random.standard_normal(len(t))
    noise += np.sqrt(common) * np.repeat(random.standard_normal(BLOCKS), ROWS)
    x = -np.linalg.lstsq(jacobian, noise, rcond=None)[0]
    model = coordinates.model_at(x)
    fit = FittedModel(model, noise + jacobian @ x, jacobian, coordinates)
    predictor = SimpleNamespace(
        block=np.repeat(np.arange(BLOCKS), ROWS),
        trace=np.repeat(np.arange(RECORDINGS), BLOCKS * ROWS // RECORDINGS),
        traces=[SimpleNamespace(recording=str(k)) for k in range(RECORDINGS)],
        plant=PLANT,
        fits_nuisance=False,
    )
    return predictor, fit, x


def held(interval_of, common):
    """How many intervals of the offset hold the truth, 0."""
    count = 0
    for seed in range(DIAGNOSES):
        low, high = interval_of(*toy(seed, common))
        count += low <= 0 <= high
    return count


def reported(predictor, fit, x):
    own = estimates(predictor, fit)[0]["offset"]
    assert own.value == fit.model[0].values[0]
    return own.low, own.high


def of_white_noise(predictor, fit, x):
    spread = np.sqrt(np.linalg.inv(fit.jacobian.T @ fit.jacobian)[0, 0])
    return x[0] - Z_80 * spread, x[0] + Z_80 * spread


LIKELY = binom.interval(0.999, DIAGNOSES, 0.8)


@pytest.mark.parametrize("common", [0.0, 0.5])
def test_intervals_hold_the_truth_as_often_as_they_say(common):
    assert LIKELY[0] <= held(reported, common) <= LIKELY[1]


def test_white_noise_would_make_them_too_narrow():
    assert held(of_white_noise, 0.0) >= LIKELY[0]
    assert held(of_white_noise, 0.5) < LIKELY[0]


def test_recordings_that_disagree_widen_an_interval():
    """A value that changes from recording to recording, as much as it is large."""
    predictor, fit, _ = toy(0, 0.0)
    signs = np.array([1.0, -1.0, 1.0, -1.0])[predictor.trace]
    shifted = fit.residual + 5.0 * signs * fit.jacobian[:, 0]
    apart = FittedModel(fit.model, shifted, fit.jacobian, fit.coordinates)
    # the mean of four values that are 5 off either way: 5 / sqrt(3)
    spread = spread_of_recordings(predictor, apart)[0]
    assert spread == pytest.approx(5.0 / np.sqrt(3), rel=0.3)
    assert standard_errors(predictor, apart)[0] >= spread
    assert spread_of_recordings(predictor, fit)[0] < 0.2 * spread


def test_recordings_that_disagree_widen_an_interval_though_their_parts_agree():
    """Two recordings of two parts each: leaving out one part tells too little."""
    predictor, fit, _ = toy(0, 0.0)
    predictor.traces = [SimpleNamespace(recording=str(k // 2)) for k in range(4)]
    signs = np.array([1.0, 1.0, -1.0, -1.0])[predictor.trace]
    shifted = fit.residual + 5.0 * signs * fit.jacobian[:, 0]
    apart = FittedModel(fit.model, shifted, fit.jacobian, fit.coordinates)
    # two values that are 5 off either way: 5 sqrt(2) apart, their mean 5
    error = errors_between_recordings(predictor, apart)[0]
    assert error == pytest.approx(5.0, rel=0.2)
    assert error > 1.4 * standard_errors(predictor, apart)[0]
    alike = errors_between_recordings(predictor, fit)[0]
    assert alike == pytest.approx(standard_errors(predictor, fit)[0], rel=0.5)


def test_each_recording_says_its_own_value():
    predictor, fit, x = toy(0, 0.0)
    signs = np.array([1.0, -1.0, 1.0, -1.0])
    shifted = fit.residual + 5.0 * signs[predictor.trace] * fit.jacobian[:, 0]
    apart = FittedModel(fit.model, shifted, fit.jacobian, fit.coordinates)
    found = said_alone(predictor, apart)
    assert list(found) == ["0", "1", "2", "3"]
    own = np.array([values[0] for values, _ in found.values()])
    # the residual grows with the value, so that a larger one asks for a smaller value
    np.testing.assert_allclose(own - x[0], -5.0 * signs, rtol=0.4)
    alone = estimates(predictor, apart)[0]["offset"].recordings
    scale = fit.coordinates.values_at(np.array([1.0, 0.0, 0.0]))[0]
    assert [one.value for one in alone.values()] == pytest.approx(scale * own)
    assert all(one.low < one.value < one.high for one in alone.values())


def test_recordings_that_agree_say_the_value_in_their_intervals():
    held = 0
    for seed in range(DIAGNOSES // RECORDINGS):
        predictor, fit, _ = toy(seed, 0.0)
        own = estimates(predictor, fit)[0]["offset"].recordings
        held += sum(one.low <= 0 <= one.high for one in own.values())
    assert LIKELY[0] <= held <= LIKELY[1]


def test_a_single_recording_or_one_without_news_says_nothing_alone():
    predictor, fit, _ = toy(0, 0.0)
    predictor.traces = [SimpleNamespace(recording="all") for _ in range(RECORDINGS)]
    assert estimates(predictor, fit)[0]["offset"].recordings == {}
    predictor, fit, _ = toy(0, 0.0)
    silent = np.where((predictor.trace == 1)[:, None], [0.0, 1, 1], 1) * fit.jacobian
    muted = FittedModel(fit.model, fit.residual, silent, fit.coordinates)
    offset, spring = estimates(predictor, muted)
    assert list(offset["offset"].recordings) == ["0", "2", "3"]
    assert list(spring["stiffness"].recordings) == ["0", "1", "2", "3"]


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_the_least_share_of_a_recording_does_not_matter(monkeypatch, factor):
    monkeypatch.setattr(module, "LEAST_SHARE", factor * module.LEAST_SHARE)
    test_recordings_that_disagree_widen_an_interval_though_their_parts_agree()


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_other_starts_that_fits_do_not_come_back_from_widen_an_interval(share):
    """An interval grows by what the ends keep of their starts' distance."""
    predictor, fit, x = toy(1, 0.0)

    def ends(nuisance, starts):
        return fit.coordinates.of(fit.model) + share * (starts - x)

    def half(some):
        own = estimates(some, fit)[0]["offset"]
        scale = fit.coordinates.values_at(np.array([1.0, 0.0, 0.0]))[0]
        return (own.high - own.low) / 2 / scale

    alone = half(predictor)
    predictor.fits_nuisance, predictor.nuisance = True, "small mismatch"
    predictor.nuisance_fit = lambda model: SimpleNamespace(ends=ends)
    far = Z_80 * share * STEP
    assert half(predictor) == pytest.approx(np.hypot(alone, far), rel=1e-6)


@pytest.mark.parametrize("share", [0.0, 0.7, -0.7])
def test_what_values_absorb_if_a_gear_yields_widens_an_interval(share):
    """Teeth that yield leave more by this share of what a larger gap changes."""
    predictor, fit, _ = toy(1, 0.0)
    play, spring = PlacedEffect("backlash", "elbow", (0.01,)), fit.model[1]
    model = play, spring
    fit = FittedModel(model, fit.residual, fit.jacobian, Coordinates(PLANT, model))

    def residuals(models):
        yields = [len(one[0].values) > len(play.values) for one in models]
        return fit.residual + share * np.outer(yields, fit.jacobian[:, 0])

    predictor.residuals = lambda models: np.tile(fit.residual, (len(models), 1))
    before = estimates(predictor, fit)[0]["gap"]
    predictor.residuals = residuals
    after = estimates(predictor, fit)[0]["gap"]
    scale = fit.coordinates.values_at(np.array([1.0, 0.0, 0.0]))[0]
    far = Z_80 * abs(share) * scale
    known = np.hypot(before.high - before.value, far)
    assert after.high - after.value == pytest.approx(known, rel=5e-3)


def test_names_and_order_are_those_of_the_effects():
    predictor, fit, _ = toy(1, 0.0)
    first, second = estimates(predictor, fit)
    assert list(first) == ["offset"]
    assert list(second) == ["stiffness", "rest"]
    assert second["stiffness"].low == 0.0  # its bound: springs do not push away
    assert standard_errors(predictor, fit).shape == (3,)


def test_what_the_data_do_not_show_has_no_narrow_interval():
    """Two columns alike: only their sum is known."""
    predictor, fit, _ = toy(2, 0.0)
    alike = fit.jacobian[:, [0, 0, 2]]
    known = standard_errors(predictor, fit)
    unknown = standard_errors(
        predictor, FittedModel(fit.model, fit.residual, alike, fit.coordinates)
    )
    assert unknown[0] > 10 * known[0]
