"""Controls: what must do worse than the truth."""

from types import SimpleNamespace

import numpy as np
import pytest
from made_up_traces import arm, recorded

from diagnosis.conclude.controls import controls_of
from diagnosis.conclude.held_out_errors import (
    FAINT,
    held_out_errors,
    share_that_follows,
)
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Channels, Predictor

CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, 4e-4))
TRUTH = PlacedEffect("servo_gain", "elbow", (0.8,))
PLANT = arm()


def controls(predictor, *model, alike=(), seed=1):
    rng = np.random.default_rng(seed)
    return SimpleNamespace(**controls_of(predictor, model, alike, rng))


@pytest.fixture(scope="module")
def predictor():
    trace = recorded(PLANT, ("servo_gain", "elbow", 0.8), duration_s=2.0)
    predictor = Predictor(PLANT, [trace], CHANNELS, step_s=0.004)
    predictor.calibrate()
    return predictor.nominal()


def energy(predictor, model):
    (residual,) = predictor.residuals([model])
    return 0.5 * residual @ residual


def test_the_same_effect_elsewhere_does_its_best_and_is_worse(predictor):
    found = controls(predictor, TRUTH)
    assert found.without == ()
    (placed,) = found.wrong_place
    assert placed.key == "servo_gain@shoulder"
    assert placed.values != TRUTH.values
    unfitted = PlacedEffect("servo_gain", "shoulder", TRUTH.values)
    assert energy(predictor, (placed,)) < energy(predictor, (unfitted,))
    assert energy(predictor, (placed,)) > 20 * energy(predictor, (TRUTH,))


@pytest.mark.parametrize("at_once", [1, 8])
def test_of_a_pair_the_main_effect_is_replaced(predictor, monkeypatch, at_once):
    monkeypatch.setattr("diagnosis.conclude.controls.AT_ONCE", at_once)
    friction = PlacedEffect("viscous_friction", "shoulder", (0.01,))
    for pair in ((TRUTH, friction), (friction, TRUTH)):
        found = controls(predictor, *pair)
        assert [one.key for one in found.without] == [friction.key]
        keys = [one.key for one in found.wrong_place]
        assert keys == [friction.key, "servo_gain@shoulder"]
        kept, other = found.wrong_effect
        assert kept.key == friction.key
        assert other.place == "elbow"
        assert other.name != "servo_gain"


def test_what_has_one_place_has_no_wrong_one(predictor):
    latency = PlacedEffect("command_latency", "commands", (0.01,))
    found = controls(predictor, latency)
    assert found.wrong_place is None
    assert found.wrong_effect is None
    both_shoulders = PlacedEffect("servo_gain", "shoulder", (1.01,))
    assert controls(predictor, TRUTH, both_shoulders).wrong_place is None


@pytest.mark.slow
def test_another_effect_is_drawn_by_lot(predictor):
    """With as many values as the true one, and none that explains the same."""
    drawn = {
        controls(predictor, TRUTH, seed=seed).wrong_effect[0].key for seed in range(8)
    }
    assert len(drawn) > 3
    assert TRUTH.key not in drawn
    alike = {"armature@elbow", "torque_limit@elbow", "viscous_friction@elbow"}
    others = {
        controls(predictor, TRUTH, alike=alike, seed=seed).wrong_effect[0]
        for seed in range(8)
    }
    assert not alike & {one.key for one in others}
    assert {len(one.values) for one in others} == {1}
    for one in others:
        assert energy(predictor, (one,)) > 5 * energy(predictor, (TRUTH,))


def test_what_contains_an_effect_is_no_other_effect(predictor):
    dry = PlacedEffect("coulomb_friction", "elbow", (0.1,))
    worn = PlacedEffect("stribeck_friction", "elbow", (0.1, 0.05, 0.1))
    for one, other in ((dry, worn), (worn, dry)):
        for seed in range(8):
            found = controls(predictor, one, seed=seed)
            assert found.wrong_effect[0].key != other.key


def sims(*seeds, effects=(("servo_gain", "elbow", 0.8),)):
    """Predictors of learned and of held-out recordings of an arm."""
    found = []
    for seed in seeds:
        trace = recorded(PLANT, *effects, duration_s=8.0, seed=seed, noise_rad=4e-4)
        one = Predictor(PLANT, [trace], CHANNELS, step_s=0.004)
        one.calibrate()
        found.append(one)
    return found[0], found[1]


def judged(nominal, model, least_shown=9.0):
    both, test = nominal
    for one in (both, test):
        one.doubt_beside(one.nuisance, model)
    seed, nothing = np.random.SeedSequence(1), SimpleNamespace(winner=None)
    usual = nominal
    return held_out_errors(usual, (both, test), nothing, model, least_shown, seed)


@pytest.fixture(scope="module")
def weak():
    return sims(1, 2)


@pytest.mark.slow
def test_a_wrong_place_is_surely_worse_where_much_is_shown(weak):
    fit, judgement = judged(weak, (TRUTH,))
    assert judgement.limits == ()
    assert judgement.worse["wrong_place"] > 2.5
    assert fit.corrected < 0.5 * fit.nominal


def test_what_held_out_data_hardly_show_is_judged_by_all(weak):
    _, judgement = judged(weak, (TRUTH,), least_shown=1e9)
    assert judgement.limits == (FAINT,)
    assert judgement.worse["wrong_place"] > 2.5


def test_how_much_a_control_explains_since_the_effect_is_real():
    """Two parts: what the effect changes, and a control at 60 degrees to it."""
    changed = {"own": [[3.0, 0.0], [0.0, 4.0]], "same": [[-1.5, 0.0], [0.0, -2.0]]}
    own = np.array(changed["own"])
    apart = 0.5 * own + np.sqrt(0.75) * np.array([[0.0, 3.0], [4.0, 0.0]])
    changed |= {"none": np.zeros((2, 2)), "apart": apart}

    def part(i):
        def residuals(models):
            return np.array([np.array([1.0, 2.0]) - changed[one][i] for one in models])

        return SimpleNamespace(residuals=residuals)

    def share(control):
        return share_that_follows([part(0), part(1)], "own", control, "none")

    assert share("own") == pytest.approx(1.0)
    assert share("same") == pytest.approx(1.0)
    assert share("apart") == pytest.approx(0.25)
    assert share("none") == 0.0


@pytest.mark.slow
def test_a_gain_elsewhere_is_no_twin(weak):
    _, judgement = judged(weak, (TRUTH,))
    assert judgement.follows["wrong_place"] < 0.5
