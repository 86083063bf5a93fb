"""Small mismatch that is said: what recordings show for sure."""

import numpy as np
import pytest
from known_arms import CHANNELS, NOISE_RAD
from made_up_traces import arm, recorded

from diagnosis.conclude.nuisance_found import sure_nuisance, with_unusual_ones
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Channels, Predictor

RUBS, WEAK = ("coulomb_friction", "elbow", 0.05), ("servo_gain", "shoulder", 0.93)
LEAST = 8.0


def calibrated(*effects, model=(), noise_rad=NOISE_RAD):
    traces = [
        recorded(arm(), *effects, duration_s=2.0, seed=seed, noise_rad=noise_rad)
        for seed in range(2)
    ]
    noise = Channels(CHANNELS.names, np.full(2, noise_rad))
    predictor = Predictor(arm(), traces, noise)
    predictor.calibrate(model)
    return predictor


def said(*effects, model=(), least_gain=LEAST, noise_rad=NOISE_RAD):
    predictor = calibrated(*effects, model=model, noise_rad=noise_rad)
    return sure_nuisance(predictor, model, least_gain)


@pytest.mark.parametrize(("torque_nm", "is_added"), [(0.05, False), (0.2, True)])
def test_an_error_that_is_larger_than_usual_is_missing_physics(torque_nm, is_added):
    """Weak friction is 0.04 N m here, three times as much is unusual."""
    rubs = "coulomb_friction", "elbow", torque_nm

    class Data:
        def calibrated(self, model):
            return (calibrated(rubs, model=model),) * 2

    model, *_ = with_unusual_ones(Data(), (), LEAST)
    assert [one.key for one in model] == ["coulomb_friction@elbow"] * is_added
    if is_added:
        assert model[0].values[0] == pytest.approx(torque_nm, rel=0.1)


def test_what_a_model_states_is_small_and_dry_friction_is_not():
    small, larger = said(RUBS, WEAK)
    assert ("servo_gain", "shoulder") in {(one.name, one.place) for one in small}
    (rubs,) = larger
    assert (rubs.name, rubs.place) == ("coulomb_friction", "elbow")
    torque = rubs.parameters["torque"]
    assert torque.value == pytest.approx(0.05, rel=0.1)
    assert torque.low < torque.value < torque.high
    assert 0.5 < rubs.probability < 1
    assert all(one.probability is None for one in small)


def test_friction_that_is_next_to_none_is_small():
    """2 % of the weak friction of 0.04 N m; the noise is small enough to see it."""
    small, larger = said(("coulomb_friction", "elbow", 8e-4), noise_rad=NOISE_RAD / 50)
    assert larger == ()
    assert ("coulomb_friction", "elbow") in {(one.name, one.place) for one in small}


def test_of_a_robot_as_exact_as_its_model_nothing_is_said():
    assert said() == ((), ())


def test_nothing_is_said_of_what_the_model_of_a_diagnosis_has():
    model = (PlacedEffect("coulomb_friction", "elbow", (0.05,)),)
    assert said(RUBS, model=model)[1] == ()
    # nor of what explains less than chance may
    assert said(RUBS, WEAK, least_gain=1e6) == ((), ())
