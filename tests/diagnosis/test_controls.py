"""Controls: what must do worse than the truth."""

import numpy as np
import pytest
from made_up_search import judged
from made_up_traces import arm, recorded

from diagnosis.controls import wrong_effects, wrong_places
from diagnosis.effect import Placed
from diagnosis.predictor import Channels, Predictor

CHANNELS = Channels(("position.shoulder", "position.elbow"), np.full(2, 4e-4))
TRUTH = Placed("servo_gain", "elbow", (0.8,))
PLANT = arm()


@pytest.fixture(scope="module")
def predictor():
    trace = recorded(PLANT, ("servo_gain", "elbow", 0.8), duration_s=2.0)
    predictor = Predictor(PLANT, [trace], CHANNELS, step_s=0.004)
    predictor.calibrate()
    return predictor


def energy(predictor, model):
    (residual,) = predictor.residuals([model])
    return 0.5 * residual @ residual


def test_the_same_effect_elsewhere_does_its_best_and_is_worse(predictor):
    model = wrong_places(predictor, (TRUTH,))
    (placed,) = model
    assert placed.key == "servo_gain@shoulder"
    assert placed.values != TRUTH.values
    unfitted = Placed("servo_gain", "shoulder", TRUTH.values)
    assert energy(predictor, model) < energy(predictor, (unfitted,))
    assert energy(predictor, model) > 20 * energy(predictor, (TRUTH,))


def test_of_a_pair_one_effect_moves(predictor):
    model = (TRUTH, Placed("servo_gain", "shoulder", (1.01,)))
    assert wrong_places(predictor, model) is None  # each other's place is taken
    other = Placed("viscous_friction", "shoulder", (0.01,))
    keys = {placed.key for placed in wrong_places(predictor, (TRUTH, other))}
    assert keys == {"servo_gain@elbow", "viscous_friction@elbow"}


def test_what_has_one_place_has_no_wrong_one(predictor):
    latency = Placed("command_latency", "commands", (0.01,))
    assert wrong_places(predictor, (latency,)) is None


def test_the_best_other_effect_at_the_place(predictor):
    tried = [
        judged(PLANT, 100.0, "servo_gain@elbow"),
        judged(PLANT, 102.0, "armature@elbow"),
        judged(PLANT, 110.0, "viscous_friction@shoulder"),
        judged(PLANT, 120.0, "viscous_friction@elbow"),
        judged(PLANT, 130.0, "coulomb_friction@elbow"),
    ]
    model = tried[0].model
    assert wrong_effects(predictor, model, tried, set()) == tried[1].model
    tied = {"armature@elbow"}
    assert wrong_effects(predictor, model, tried, tied) == tried[3].model
    assert wrong_effects(predictor, model, tried[:1], set()) is None
