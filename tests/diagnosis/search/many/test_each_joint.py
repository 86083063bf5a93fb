"""Many effects are found at each joint by itself, whatever the settings exactly are."""

import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.judging import Judge
from diagnosis.search.many import each_joint, stepwise
from diagnosis.search.many.fits import Fits
from diagnosis.search.many.pruning import pruned, shared

JOINTS = "yaw", "shoulder", "elbow"
DRY_NM, VISCOUS_NM_S = (1.0, 0.5, 0.2), (0.0, 2.0, 0.3)
TRUE = {
    **{f"coulomb_friction@{j}": nm for j, nm in zip(JOINTS, DRY_NM, strict=True)},
    "viscous_friction@shoulder": 2.0,
    "viscous_friction@elbow": 0.3,
}


@pytest.fixture(scope="module")
def judge():
    rubs = rubbing(DRY_NM, VISCOUS_NM_S)
    parts = []
    for seed in (0, 1):
        found = predictor_of(arm(), with_motions(arm(), [moved(rubs, seed=seed)]))
        found.calibrate()
        parts.append(found)
    return Judge(*parts)


def values(judged):
    return {placed.key: placed.values[0] for placed in judged.model}


def found(judge):
    fits = Fits(judge)
    return values(pruned(fits, each_joint.each_joint(fits)))


@pytest.mark.slow
def test_friction_is_found_at_each_joint(judge):
    assert found(judge) == pytest.approx(TRUE, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "name", "value"),
    [
        (stepwise, "TRUSTED", 0.025),
        (stepwise, "TRUSTED", 0.1),
        (stepwise, "UNSURE", 10.0),
        (stepwise, "UNSURE", 40.0),
        (stepwise, "MOST_AT_ONCE", 15),
        (each_joint, "BEGUN", 2),
        (each_joint, "BEGUN", 10),
        (each_joint, "EXCHANGED", 4),
        (each_joint, "EXCHANGED", 16),
    ],
)
def test_a_factor_of_two_does_not_matter(monkeypatch, judge, module, name, value):
    monkeypatch.setattr(module, name, value)
    assert found(judge) == pytest.approx(TRUE, rel=0.1)


def test_joints_whose_friction_differs_clearly_are_not_tied(judge):
    fits = Fits(judge)
    best = shared(fits, each_joint.each_joint(fits))
    assert {placed.tied for placed in best.model} == {""}
    assert TRUE.keys() <= values(best).keys()
