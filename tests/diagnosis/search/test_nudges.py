import numpy as np
import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.coordinates import Coordinates
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.fitting import fit_all
from diagnosis.search.nudges import nudges_of

JOINTS = "yaw", "shoulder", "elbow"


def friction(*joints, tied=""):
    return tuple(
        PlacedEffect("coulomb_friction", joint, (0.5,), tied=tied) for joint in joints
    )


PAYLOAD = PlacedEffect("payload_mass", "lower", (0.1,))


@pytest.fixture(scope="module")
def predictor():
    rubs = rubbing((1.0, 2.0, 0.5), (0.0, 0.0, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found.nominal()


def grouped(predictor, model):
    return nudges_of(predictor, Coordinates(predictor.plant, model)).groups


def test_values_of_many_joints_are_changed_together(predictor):
    assert grouped(predictor, (*friction(*JOINTS), PAYLOAD)) == [[0, 1, 2], [3]]


def test_values_of_few_joints_are_changed_one_by_one(predictor):
    assert grouped(predictor, friction("yaw", "elbow")) == [[0], [1]]


def test_a_shared_value_is_changed_once(predictor):
    assert grouped(predictor, friction(*JOINTS, tied="all")) == [[0]]


def test_what_moves_other_joints_is_changed_alone(predictor):
    offsets = tuple(PlacedEffect("encoder_offset", one, (0.01,)) for one in JOINTS)
    assert grouped(predictor, offsets) == [[0], [1], [2]]


def test_joints_together_are_fitted_as_one_by_one(predictor):
    """Two joints are below `MANY`, so that their values are changed one by one."""
    (together,) = fit_all(predictor, [friction(*JOINTS)])
    assert [one.values[0] for one in together.model] == pytest.approx(
        [1.0, 2.0, 0.5], rel=0.05
    )
    (alone,) = fit_all(predictor, [friction("yaw", "shoulder")])
    for found, single in zip(together.model, alone.model, strict=False):
        assert found.values == pytest.approx(single.values, rel=1e-3)


def test_each_joint_keeps_to_its_own_channels(predictor):
    (fit,) = fit_all(predictor, [friction(*JOINTS)], 1)
    own = np.isin(predictor.channel, predictor.channels.of_joint("yaw"))
    assert np.abs(fit.jacobian[own, 0]).max() > 0
    assert not fit.jacobian[~own, 0].any()


def test_a_shared_value_is_the_best_one_for_all(predictor):
    (fit,) = fit_all(predictor, [friction(*JOINTS, tied="all")])
    values = {one.values for one in fit.model}
    assert len(values) == 1
    assert fit.jacobian.shape[1] == 1
    assert 0.5 < values.pop()[0] < 2.0
    (each,) = fit_all(predictor, [friction(*JOINTS)])
    assert each.energy < 0.5 * fit.energy
