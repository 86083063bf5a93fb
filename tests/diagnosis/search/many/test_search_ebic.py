"""The criterion by which a search for effects at all joints decides."""

import numpy as np
import pytest
from made_up_search import judged
from made_up_traces import arm, recorded

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.ties import tied
from diagnosis.search.many.ebic import Ebic

CRITERION = Ebic(samples=100.0, candidates=50, joints=4)
VALUE, CHOICE = 0.5 * np.log(100.0), np.log(50.0)
JOINTS = "a", "b", "c"


def friction(*joints):
    return tuple(PlacedEffect("coulomb_friction", one, (0.1,)) for one in joints)


def test_each_value_costs_and_each_choice():
    late = PlacedEffect("command_latency", "commands", (0.01,))
    assert CRITERION.price(()) == 0
    assert CRITERION.price(friction("a")) == pytest.approx(VALUE + CHOICE)
    assert CRITERION.price((*friction("a"), late)) == pytest.approx(
        2 * (VALUE + CHOICE)
    )


def test_an_effect_at_half_of_the_joints_is_one_choice():
    assert CRITERION.price(friction("a", "b")) == pytest.approx(2 * VALUE + CHOICE)
    wide = Ebic(samples=100.0, candidates=50, joints=7)
    assert wide.price(friction("a", "b")) == pytest.approx(2 * (VALUE + CHOICE))


def test_what_is_shared_costs_one_value():
    plant = arm()
    each = tuple(PlacedEffect("coulomb_friction", one, (0.1,)) for one in plant.joints)
    shared = tied(plant, each, "all")
    assert CRITERION.price(each) - CRITERION.price(shared) == pytest.approx(VALUE)
    assert CRITERION.price_within(shared, shared) == CRITERION.price(shared)


def test_joints_that_share_a_value_are_one_choice_if_they_are_all_of_a_motor():
    some = tuple(PlacedEffect("armature", one, (0.1,), tied="a") for one in ("a", "b"))
    motor = frozenset({frozenset({"a", "b"}), frozenset({"c"})})
    chosen = Ebic(samples=100.0, candidates=50, joints=7)
    given = Ebic(samples=100.0, candidates=50, joints=7, alike=motor)
    assert chosen.price(some) == pytest.approx(VALUE + 2 * CHOICE)
    assert given.price(some) == pytest.approx(VALUE + CHOICE)


def test_a_larger_model_must_lower_the_error_by_its_price():
    """A price is worth it where n samples leave exp(-2 price / n) of the energy."""
    plant = arm()
    one = judged(plant, 1000.0, "coulomb_friction@elbow")
    price = CRITERION.price(one.model)
    just = np.exp(2 * price / CRITERION.samples)
    assert CRITERION.prefers(one, judged(plant, 1000.0 * just * 1.01))
    assert not CRITERION.prefers(one, judged(plant, 1000.0 * just * 0.99))


def samples(residual_of):
    predictor = Predictor(arm(), [recorded(arm(), duration_s=20.0)])
    count = len(predictor.channels.names)
    residual = residual_of(len(predictor.scored) // count, count).reshape(-1)
    return predictor, Ebic.of(predictor, predictor, residual * predictor.scored).samples


def test_an_error_that_lasts_is_one_sample():
    random = np.random.default_rng(1)

    def white(rows, channels):
        return random.standard_normal((rows, channels))

    def lasting(rows, channels):
        return np.repeat(white(-(-rows // 50), channels), 50, axis=0)[:rows]

    predictor, short = samples(white)
    _, long = samples(lasting)
    # blocks have four rows at least, and both sets of recordings count
    assert short == pytest.approx(2 * predictor.scored.sum() / 4, rel=0.05)
    assert 2 * predictor.scored.sum() / 400 < long < 2 * predictor.scored.sum() / 25
