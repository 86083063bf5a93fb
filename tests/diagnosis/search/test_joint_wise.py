import numpy as np
import pytest
from known_arms import CHANNELS, measured
from made_up_traces import arm

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.search.all_joints import joint_wise
from diagnosis.search.fitting import fit_all

START = tuple(
    PlacedEffect("servo_gain", joint, (1.0,)) for joint in ("shoulder", "elbow")
)


@pytest.fixture(scope="module")
def predictor():
    some = Predictor(arm(), [measured(1, gain=(0.9, 0.8))], CHANNELS)
    some.calibrate()
    return some.without_tolerances()


def test_all_joints_are_fitted_at_once(predictor):
    (found,) = fit_all(predictor, [START], nudges_of=joint_wise)
    assert [placed.values[0] for placed in found.model] == [
        pytest.approx(0.9, abs=0.01),
        pytest.approx(0.8, abs=0.01),
    ]
    (slow,) = fit_all(predictor, [START])
    assert found.energy == pytest.approx(slow.energy, rel=0.01)


def test_values_of_one_kind_are_nudged_together_and_keep_to_their_joint(predictor):
    model = (*START, PlacedEffect("command_latency", "commands", (0.0,)))
    assert joint_wise(predictor, model).groups == [[0, 1], [2]]
    (found,) = fit_all(predictor, [model], steps=1, nudges_of=joint_wise)
    shoulder = predictor.channel == CHANNELS.names.index("position.shoulder")
    assert not found.jacobian[~shoulder, 0].any()
    assert not found.jacobian[shoulder, 1].any()
    assert np.abs(found.jacobian[shoulder, 2]).max() > 0
    assert np.abs(found.jacobian[~shoulder, 2]).max() > 0


def test_two_models_side_by_side_are_as_each_alone(predictor):
    other = (START[0],)
    both = fit_all(predictor, [START, other], nudges_of=joint_wise)
    alone = [
        fit_all(predictor, [one], nudges_of=joint_wise)[0] for one in (START, other)
    ]
    for found, single in zip(both, alone, strict=True):
        assert found.energy == pytest.approx(single.energy, rel=1e-9)
