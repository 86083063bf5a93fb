"""What differs from recording to recording is no evidence of something missing."""

from dataclasses import replace

import numpy as np
import pytest
from differing_gains import CHANNELS, GAIN, predictor_of
from made_up_traces import arm, recorded
from scipy.stats import norm, t

from diagnosis.conclude import between_recordings
from diagnosis.conclude.between_recordings import Sizes, may_be_scatter, scattered
from diagnosis.conclude.guards import established
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.fitting import fit_all


@pytest.mark.parametrize(
    ("gains", "expected"),
    [((1.03, 1.03), False), ((1.07, 0.99), True), ((1.6, 1.58), False)],
)
def test_an_effect_that_recordings_disagree_on_is_scatter(gains, expected):
    both = predictor_of(gains)
    (fitted,) = fit_all(both, [GAIN])
    assert bool(scattered(both, [], fitted)) == expected
    kept, _ = established(both, GAIN)
    assert (kept is None) == expected


def test_of_a_kind_at_all_joints_one_may_differ():
    """The elbow's gain differs by more than it is off; the shoulder's is surely off."""
    both = (("elbow", (1.07, 0.99)), ("shoulder", (1.5, 1.5)))
    traces = [
        replace(
            recorded(arm(), *(("servo_gain", j, own[k]) for j, own in both), seed=k),
            name=str(k),
        )
        for k in range(2)
    ]
    model = tuple(PlacedEffect("servo_gain", j, (own[0],)) for j, own in both)
    predictor = Predictor(arm(), traces, CHANNELS)
    predictor.calibrate(model, tolerances=False)
    (fitted,) = fit_all(predictor, [model])
    assert scattered(predictor, [], fitted) == []


@pytest.mark.parametrize(
    ("before", "expected"), [((1.0, 1.0), False), ((1.05, 0.95), True)]
)
def test_the_healthy_robot_shows_how_much_recordings_differ(before, expected):
    both, healthy = predictor_of((1.03, 1.03)), predictor_of(before, first=5)
    (fitted,) = fit_all(both, [GAIN])
    assert bool(scattered(both, [healthy], fitted)) == expected


def test_what_does_not_last_need_not_be_in_all_recordings():
    push = "external_force", "lower", 5.0, 0.0, 0.0, 1.0, 0.5
    traces = [
        replace(recorded(arm(), *own, seed=k), name=f"recording {k}")
        for k, own in enumerate(([push], []))
    ]
    both = Predictor(arm(), traces, CHANNELS)
    model = (PlacedEffect(push[0], push[1], push[2:]),)
    both.calibrate(model, tolerances=False)
    (fitted,) = fit_all(both, [model])
    assert scattered(both, [], fitted) == []
    always = (PlacedEffect(push[0], push[1], (1.0, 0.0, 0.0, -1.0, 100.0)),)
    (fitted,) = fit_all(both, [always])
    assert scattered(both, [], fitted) != []


def of(*sizes, weight=100.0):
    every = np.full(len(sizes), weight)
    return Sizes(np.array(sizes), every, np.arange(len(sizes)))


def test_scatter_widens_the_error_of_the_mean():
    """Two sizes 1 -+ d: scatter 2 w d^2, one degree, so that |t| = 1 / d."""
    edge = 1 / t.isf(0.025, 1)
    assert may_be_scatter([of(1 + 1.01 * edge, 1 - 1.01 * edge, weight=1e6)])
    assert not may_be_scatter([of(1 + 0.99 * edge, 1 - 0.99 * edge, weight=1e6)])


def test_scatter_that_may_be_noise_widens_nothing():
    """The recordings disagree from 1.96 standard errors of their difference on."""
    apart = norm.isf(0.025) / np.sqrt(2 * 100.0)
    assert not may_be_scatter([of(1 + 0.99 * apart, 1 - 0.99 * apart)])
    assert may_be_scatter([of(1 + 1.01 * apart, 1 - 1.01 * apart)])


def test_recordings_in_which_the_effect_hardly_shows_say_nothing():
    three = of(1.0, 1.02, 9.0, weight=1e4)
    assert may_be_scatter([three])
    hardly = three._replace(weights=three.weights * [1, 1, 1e-3])
    assert not may_be_scatter([hardly])
    assert not may_be_scatter([of(1.0)])


def test_parts_of_recordings_that_disagree_as_much_say_how_much():
    """The t of two recordings is 3.3 (1 degree of freedom), of 8 parts 5.2 (7)."""
    alone = of(1.3, 0.7, weight=400.0)
    assert may_be_scatter([alone])
    sizes = np.array([1.8, 0.8, 1.6, 1.0, 1.2, 0.2, 1.0, 0.4])
    parts = Sizes(sizes, np.full(8, 100.0), np.repeat([0, 1], 4))
    assert not may_be_scatter([parts])


def test_parts_that_agree_do_not_make_up_for_recordings_that_do_not():
    sizes = np.array([1.52, 1.48, 1.51, 1.49, 0.52, 0.48, 0.51, 0.49])
    parts = Sizes(sizes, np.full(8, 100.0), np.repeat([0, 1], 4))
    assert may_be_scatter([parts])


@pytest.mark.parametrize("constant", ["LEVEL", "LEAST_WEIGHT"])
@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_factor_of_two_does_not_matter(monkeypatch, constant, factor):
    value = getattr(between_recordings, constant)
    monkeypatch.setattr(between_recordings, constant, factor * value)
    test_the_healthy_robot_shows_how_much_recordings_differ((1.0, 1.0), False)
    test_the_healthy_robot_shows_how_much_recordings_differ((1.05, 0.95), True)
    test_an_effect_that_recordings_disagree_on_is_scatter((1.6, 1.58), False)
