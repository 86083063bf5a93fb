"""Intervals of 80 %: they must hold the truth in 80 of 100 diagnoses."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_up_traces import arm
from scipy.stats import binom

from diagnosis.conclude.estimates import Z_80, estimates, standard_errors
from diagnosis.effects.parts import PlacedEffect
from diagnosis.search.fitting import Coordinates, FittedModel

BLOCKS, ROWS = 60, 25
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
    predictor = SimpleNamespace(block=np.repeat(np.arange(BLOCKS), ROWS), plant=PLANT)
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


def test_what_sims_disagree_by_is_not_known_better():
    """Without noise 1.5 % of a value's distance from nothing; of ratios in all."""
    predictor, fit, _ = toy(0, 0.0)
    coordinates = Coordinates(
        PLANT,
        (
            PlacedEffect("viscous_friction", "elbow", (0.3,)),
            PlacedEffect("servo_gain", "shoulder", (0.8,)),
            PlacedEffect("armature", "elbow", (0.0,)),
        ),
    )
    exact = FittedModel(
        coordinates.model, 0 * fit.residual, 1e6 * fit.jacobian, coordinates
    )
    viscous, gain, armature = estimates(predictor, exact)
    friction = viscous["coefficient"]
    assert friction.high - 0.3 == pytest.approx(Z_80 * 0.015 * 0.3, rel=1e-3)
    assert 0.3 - friction.low == pytest.approx(Z_80 * 0.015 * 0.3, rel=1e-3)
    assert np.log(gain["factor"].high / 0.8) == pytest.approx(Z_80 * 0.015, rel=1e-3)
    assert armature["inertia"].high < 1e-6
    assert friction.unit == "N m s/rad"


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
