"""Which models with effects at many joints are proposed, and in which order."""

import numpy as np
import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.signatures import signatures
from diagnosis.residuals.ties import number_of_values, tied
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.fitting import fit_all
from diagnosis.search.judging import Judge
from diagnosis.search.many.kinds import kinds_to_add
from diagnosis.search.many.shared_first import servo_effects
from diagnosis.search.screening import Screen
from diagnosis.traces.usage import Usage

JOINTS = "yaw", "shoulder", "elbow"
KEYS = [f"coulomb_friction@{joint}" for joint in JOINTS]
SHARED = tied(
    arm(),
    [PlacedEffect("coulomb_friction", joint, (0.5,)) for joint in JOINTS],
    "all",
)


def predictor_with(*coulomb_nm):
    """The torques of an arm whose joints rub."""
    rubs = rubbing(coulomb_nm, (0.0, 0.0, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found.nominal()


@pytest.fixture(scope="module")
def predictor():
    return predictor_with(0.8, 0.8, 0.8)


def screen_of(predictor, model):
    usage = Usage.of(predictor.plant, predictor.traces)
    found = signatures(predictor, model, usage, (), servo_effects())
    return Screen(predictor, found)


def fitted(predictor, model):
    return Judge(predictor, predictor).judge(fit_all(predictor, [model]))[0]


def test_a_shared_value_is_guessed(predictor):
    screen = screen_of(predictor, ())
    residual = predictor.residuals([()])[0]
    nothing = np.zeros((len(residual), 0))
    guess = screen.shared(residual, nothing, KEYS)
    assert [one.key for one in guess.model] == KEYS
    values = [one.values[0] for one in guess.model]
    assert values == pytest.approx([0.8] * 3, rel=0.1)
    assert np.ptp(values) < 1e-9
    each = {one.model[0].key: one.gain for one in screen.singles(residual)}
    # guesses of single effects are at most four times as large as what was tried
    assert guess.gain > 0.95 * sum(each[key] for key in KEYS)
    assert screen.shared(residual, nothing, ["torque_limit@yaw"]) is None


def test_values_that_are_the_same_gain_nothing_by_being_freed(predictor):
    right = fitted(predictor, SHARED)
    screen = screen_of(predictor, right.model)
    few = screen.freed(right.fit.residual, right.fit.jacobian, KEYS)
    uneven = predictor_with(0.2, 0.8, 1.4)
    wrong = fitted(uneven, SHARED)
    much = screen_of(uneven, wrong.model).freed(
        wrong.fit.residual, wrong.fit.jacobian, KEYS
    )
    assert few < 0.01 * much


def test_what_joints_share_comes_first_and_what_is_tied_is_freed_later(predictor):
    best = fitted(predictor, SHARED)
    shared, apart = kinds_to_add(predictor, screen_of(predictor, best.model), best)
    assert shared
    assert all(number_of_values(one) <= 2 for one in shared)
    assert any(
        number_of_values(one) == 3 and {each.key for each in one} == set(KEYS)
        for one in apart
    )
    forms = [{each.name for each in one} for one in apart]
    assert {"stribeck_friction"} in forms
    values = [
        number_of_values(one)
        for one in apart
        if {each.name for each in one} == {"stribeck_friction"}
    ]
    assert {3, 9} <= set(values)  # the same at all joints, and another one at each
