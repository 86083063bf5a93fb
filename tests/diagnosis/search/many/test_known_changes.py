"""Jacobians at the start of fits are those that differences would show."""

import numpy as np
import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.signatures import signatures
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.fitting import fit_all
from diagnosis.search.many.known_changes import KnownChanges
from diagnosis.search.many.shared_first import united
from diagnosis.traces.usage import Usage

JOINTS = "yaw", "shoulder", "elbow"


def friction(kind, *joints, tied=""):
    return tuple(PlacedEffect(kind, joint, (0.5,), tied=tied) for joint in joints)


VISCOUS = friction("viscous_friction", *JOINTS)
SHARED = friction("viscous_friction", *JOINTS, tied="elbow")
DRY = friction("coulomb_friction", *JOINTS)


@pytest.fixture(scope="module")
def predictor():
    rubs = rubbing((1.0, 0.5, 0.2), (0.0, 2.0, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found


def known(predictor, model):
    best = fit_all(predictor, [model])[0]
    usage = Usage.of(predictor.plant, predictor.traces)
    names = "viscous_friction", "coulomb_friction", "stribeck_friction"
    found = signatures(predictor, best.model, usage, (), names)
    return best, KnownChanges(predictor, best, found)


def cosines(some, other):
    lengths = np.linalg.norm(some, axis=0) * np.linalg.norm(other, axis=0)
    return (some * other).sum(axis=0) / lengths


@pytest.mark.parametrize(
    ("model", "more"),
    [
        (VISCOUS, DRY[:1]),
        (VISCOUS[1:], DRY),
        (SHARED, friction("coulomb_friction", *JOINTS, tied="elbow")),
    ],
)
def test_further_effects_change_what_their_signatures_show(predictor, model, more):
    best, changes = known(predictor, model)
    start = (*best.model, *more)
    expected = fit_all(predictor, [start], 1)[0].jacobian
    found = changes.jacobian(start)
    assert found.shape == expected.shape
    assert cosines(found, expected) == pytest.approx(1, abs=0.02)
    sizes = np.linalg.norm(found, axis=0) / np.linalg.norm(expected, axis=0)
    assert sizes == pytest.approx(1, abs=0.1)


def test_a_value_that_is_untied_changes_its_own_joint(predictor):
    best, changes = known(predictor, SHARED)
    start = tuple(PlacedEffect(one.name, one.place, one.values) for one in best.model)
    expected = fit_all(predictor, [start], 1)[0].jacobian
    assert cosines(changes.jacobian(start), expected) == pytest.approx(1, abs=0.02)


def test_effects_with_several_values_are_not_known(predictor):
    best, changes = known(predictor, VISCOUS)
    more = PlacedEffect("stribeck_friction", "yaw", (0.5, 0.1, 0.05))
    assert changes.jacobian((*best.model, more)) is None


def keys(model):
    return {one.key for one in model}


def test_what_is_better_at_different_joints_is_united():
    """The second and the fourth are alternatives of what comes before them."""
    larger = [
        (*VISCOUS, DRY[0]),
        (*VISCOUS, *friction("load_friction", "yaw")),
        (*VISCOUS, DRY[2]),
        (*VISCOUS, PlacedEffect("command_latency", "commands", (0.01,))),
    ]
    together = united(JOINTS, VISCOUS, larger)
    assert keys(together) == keys((*VISCOUS, DRY[0], DRY[2]))
    assert united(JOINTS, VISCOUS, larger[3:]) == larger[3]
    assert united(JOINTS, VISCOUS, []) == VISCOUS


def test_what_replaces_effects_takes_their_place():
    stribeck = PlacedEffect("stribeck_friction", "yaw", (0.5, 0.1, 0.05))
    grown = (stribeck, *DRY[1:])
    untied = (*SHARED, *DRY)
    assert keys(united(JOINTS, DRY, [grown, (*DRY, VISCOUS[1])])) == keys(
        (stribeck, *DRY[1:], VISCOUS[1])
    )
    freed = united(JOINTS, untied, [(*VISCOUS, *DRY), (*untied, stribeck)])
    assert {one.tied for one in freed} == {""}
    assert keys(freed) == keys(untied)
