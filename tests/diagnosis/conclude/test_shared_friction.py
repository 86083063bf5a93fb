"""One dry friction for all joints, where small mismatch stands for it at several."""

from copy import copy

import pytest
from known_arms import CHANNELS
from made_up_traces import arm as replayed_arm
from made_up_traces import recorded
from torque_arm import JOINTS, arm, moved, rubbing

from diagnosis.conclude.nuisance_found import sure_nuisance
from diagnosis.conclude.shared_friction import with_shared_friction
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Predictor
from diagnosis.residuals.torques.torque_evidence import with_motions, with_used_torques
from diagnosis.residuals.torques.torque_predictor import predictor_of

LEAST = 8.0
OFFSET = (PlacedEffect("torque_offset", "yaw", (0.2,)),)


class Data:
    """Recordings that are asked about one model after another."""

    def __init__(self, predictor):
        self.learned = predictor

    def calibrated(self, model):
        one = copy(self.learned)
        one.calibrate(model)
        return one, one


def measured(*coulomb_nm):
    """Data of an arm with dry friction, as large as small mismatch may be."""
    change = rubbing(coulomb_nm, (0.0, 0.0, 0.0))
    traces = with_motions(arm(), [moved(change, noise_rad=1e-4)])
    predictor = predictor_of(with_used_torques(arm(), traces), traces)
    predictor.calibrate()
    return Data(predictor)


def added(data, model):
    """Effects that are in the model with shared friction only."""
    return with_shared_friction(data, model, LEAST)[len(model) :]


@pytest.mark.parametrize("model", [(), OFFSET])
def test_friction_that_is_alike_is_one_value_for_all(model):
    data = measured(0.2, 0.2, 0.2)
    more = added(data, model)
    assert {one.name for one in more} == {"coulomb_friction"}
    assert tuple(one.place for one in more) == JOINTS
    assert {one.tied for one in more} == {min(JOINTS)}
    assert more[0].values[0] == pytest.approx(0.2, rel=0.15)


def test_friction_that_differs_stays_with_its_joints():
    data = measured(0.1, 0.6, 0.1)
    both, _ = data.calibrated(())
    assert len(sure_nuisance(both, (), LEAST)[1]) == 3
    assert added(data, ()) == ()


def test_friction_of_one_joint_is_not_that_of_all():
    data = measured(0.0, 0.3, 0.0)
    assert added(data, ()) == ()


def test_friction_that_a_model_has_is_not_shared_again():
    data = measured(0.2, 0.2, 0.2)
    known = (PlacedEffect("coulomb_friction", "yaw", (0.2,)),)
    assert [one.place for one in added(data, known)] == ["shoulder", "elbow"]


def test_replays_are_not_asked():
    rubs = "coulomb_friction", "elbow", 0.05
    trace = recorded(replayed_arm(), rubs, duration_s=2.0)
    assert added(Data(Predictor(replayed_arm(), [trace], CHANNELS)), ()) == ()
