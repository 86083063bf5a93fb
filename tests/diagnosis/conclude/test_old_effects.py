"""What the healthy robot had as well is not new, and what has changed is."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from made_up_traces import NOISE_RAD, arm, recorded
from scipy.stats import chi2

from diagnosis.conclude.old_effects import Values, old_effects, without
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.channels import Channels
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.reference_noise import ReferenceNoise
from diagnosis.search.judging import Judge
from diagnosis.search.result import SearchResult
from diagnosis.search.rules import Rules

CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, NOISE_RAD))
NONE = ReferenceNoise.known((), 2)
RULES = Rules(finished=2)
RUBS = ("viscous_friction", "shoulder", 0.1), ("viscous_friction", "elbow", 0.1)
WEAK = ("servo_gain", "shoulder", 0.9)
"""At the shoulder friction and gain show in different ways."""


@cache
def predictor(*effects, seeds=(0, 1)):
    traces = [recorded(arm(), *effects, seed=seed) for seed in seeds]
    found = Predictor(arm(), traces, CHANNELS, noise=NONE)
    found.calibrate(tolerances=False)
    return found


def placed(name, place, *values, **more):
    return PlacedEffect(name, place, values, **more)


def searched(now, before, *model):
    """A judge of robots that have effects `now` and `before`, and the fitted model."""
    own, select = predictor(*now), predictor(*now, seeds=(2,))
    judge = Judge(own, select, RULES, [predictor(*before, seeds=(5, 6))])
    best = {len(model): judge.judged([model])}
    return judge, SearchResult(judge.nothing, judge.floor, best, len(model))


def old(now, before, *model):
    """Keys of the old effects in a model of robots that have effects."""
    return {one.key for one in old_effects(*searched(now, before, *model))}


RUB_KEYS = {"viscous_friction@shoulder", "viscous_friction@elbow"}
RUB_MODEL = tuple(placed(*one) for one in RUBS)


@pytest.mark.parametrize(
    ("now", "before", "expected"),
    [
        (RUBS, RUBS, RUB_KEYS),
        (RUBS, (), set()),
        (RUBS, RUBS[:1], {"viscous_friction@shoulder"}),
    ],
)
def test_old_is_what_both_robots_have(now, before, expected):
    assert old(now, before, *RUB_MODEL) == expected


def test_beside_what_is_new_old_effects_are_told():
    model = *RUB_MODEL, placed(*WEAK)
    assert old((*RUBS, WEAK), RUBS, *model) == RUB_KEYS


def test_what_joints_share_is_old_together():
    model = tuple(replace(one, tied="elbow") for one in RUB_MODEL)
    assert old(RUBS, RUBS, *model) == RUB_KEYS
    assert old(RUBS, (), *model) == set()


@pytest.mark.slow
def test_of_effects_that_explain_the_same_none_passes_as_new():
    """Left out one by one each would seem to be worth nothing, and none to be old."""
    twins = (
        placed("viscous_friction", "elbow", 0.05),
        placed("servo_damping", "elbow", 1.03),
    )
    judge, found = searched(RUBS[1:], RUBS[1:], *twins)
    had = old_effects(judge, found)
    rest = without(judge, found, had).winner
    assert had
    assert rest is None or judge.nothing_fit - rest.fit.energy > 10 * judge.least_gain
    assert not old(RUBS[1:], (), *twins)


def test_where_the_healthy_robot_stood_still_nothing_is_known_to_be_old():
    still = replace(
        recorded(arm()), command_rad=np.zeros((201, 2)), position_rad=np.zeros((201, 2))
    )
    noise = np.random.default_rng(0).standard_normal((201, 2))
    before = Predictor(
        arm(), [replace(still, position_rad=NOISE_RAD * noise)], CHANNELS, noise=NONE
    )
    before.calibrate(tolerances=False)
    judge, found = searched(RUBS, (), *RUB_MODEL)
    judge.healthy = [before]
    assert old_effects(judge, found) == ()


@pytest.mark.slow
@pytest.mark.parametrize(("before", "expected"), [((), 0), ("limited", 1)])
def test_a_limit_that_no_finite_value_switches_off(before, expected):
    limited = (("torque_limit", "elbow", 1.2),)
    before = limited if before else ()
    found = old(limited, before, placed("torque_limit", "elbow", 1.2))
    assert len(found) == expected


def test_without_a_reference_or_effects_nothing_is_old():
    judge, found = searched(RUBS, (), *RUB_MODEL)
    judge.healthy = []
    assert old_effects(judge, found) == ()
    assert old_effects(judge, replace(found, chosen=0)) == ()


def test_what_is_left_without_old_effects_is_fitted_again():
    model = *RUB_MODEL, placed(*WEAK)
    judge, found = searched((*RUBS, WEAK), RUBS, *model)
    left = without(judge, found, RUB_MODEL)
    assert left.winner.keys == {"servo_gain@shoulder"}
    assert without(judge, found, model).winner is None
    assert without(judge, found, (placed("encoder_noise", "elbow", 1.0),)) is found


UNIT = np.eye(3)


def test_values_count_as_far_off_from_the_gain_that_the_best_reaches_by_chance():
    """The largest of three exceeds this distance once in a hundred, if all are zero."""
    edge = np.sqrt(chi2.isf(0.01 / 3, 1))
    groups = [[0], [1], [2]]
    assert Values(np.array([0.99 * edge, 0, 0]), UNIT).far_off(groups) == []
    assert Values(np.array([0, 1.01 * edge, 0]), UNIT).far_off(groups) == [1]
    pair = np.sqrt(chi2.isf(0.01 / 2, 2))
    assert Values(np.array([0.99 * pair, 0, 0]), UNIT).far_off([[0, 1], [2]]) == []
    assert Values(np.array([1.01 * pair, 0, 0]), UNIT).far_off([[0, 1], [2]]) == [0]


def test_one_value_makes_up_for_others_whose_errors_go_with_its_own():
    """Only the sum of the first two is known: either may be the one that is off."""
    alike = np.array([[1.0, -0.99, 0], [-0.99, 1.0, 0], [0, 0, 1.0]]) * 100
    far = Values(np.array([20.0, 20.0, 0.0]), alike)
    assert len(far.far_off([[0], [1], [2]])) == 1
    assert sorted(replace(far, covariance=UNIT).far_off([[0], [1], [2]])) == [0, 1]


def test_differences_of_values_are_as_uncertain_as_both():
    one = Values(np.array([1.0, 2.0, 3.0]), UNIT)
    two = one.less(Values(np.array([0.5, 2.0, 1.0]), 2 * UNIT))
    np.testing.assert_allclose(two.values, [0.5, 0.0, 2.0])
    np.testing.assert_allclose(two.covariance, 3 * UNIT)
