"""Many effects are chosen at once, and exchanged, by linear estimates."""

import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.signatures import signatures
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.fitting import fit_all
from diagnosis.search.many.each_joint import EXCHANGED, lasting_effects
from diagnosis.search.many.ebic import Ebic
from diagnosis.search.many.stepwise import Stepwise
from diagnosis.search.result import Judged
from diagnosis.search.screening import Screen
from diagnosis.traces.usage import Usage

JOINTS = "yaw", "shoulder", "elbow"
DRY_NM, VISCOUS_NM_S = (1.0, 0.5, 0.2), 2.0
TRUE = {
    *(f"coulomb_friction@{joint}" for joint in JOINTS),
    "viscous_friction@shoulder",
}


def predictor_with(dry_nm, viscous_nm_s):
    rubs = rubbing(dry_nm, (0.0, viscous_nm_s, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found.nominal()


@pytest.fixture(scope="module")
def predictor():
    return predictor_with(DRY_NM, VISCOUS_NM_S)


def stepwise(predictor, *model):
    fit = fit_all(predictor, [model])[0]
    best = Judged(fit, fit.energy)
    usage = Usage.of(predictor.plant, predictor.traces)
    found = signatures(predictor, fit.model, usage, (), lasting_effects())
    ebic = Ebic.of(predictor, predictor, fit.residual)
    return Stepwise(Screen(predictor, found), ebic, best, predictor.noise_energy)


def test_all_that_is_missing_is_chosen_at_once(predictor):
    (model,) = stepwise(predictor).models(1)
    assert {placed.key for placed in model} == TRUE
    # at the shoulder the viscous friction is more than a linear estimate is trusted to
    found = {placed.key: placed.values[0] for placed in model}
    dry = [found[f"coulomb_friction@{joint}"] for joint in ("yaw", "elbow")]
    assert dry == pytest.approx([DRY_NM[0], DRY_NM[2]], rel=0.1)


def test_others_do_without_one_kind_of_the_best(predictor):
    first, *others = (
        {placed.name for placed in model} for model in stepwise(predictor).models(5)
    )
    assert first == {"coulomb_friction", "viscous_friction"}
    assert len(others) == 2
    assert [first - other for other in others] in (
        [{"coulomb_friction"}, {"viscous_friction"}],
        [{"viscous_friction"}, {"coulomb_friction"}],
    )


def test_what_the_model_has_is_not_added_again(predictor):
    known = PlacedEffect("viscous_friction", "shoulder", (1.0,))
    (model,) = stepwise(predictor, known).models(1)
    added = {placed.key for placed in model}
    assert added == TRUE - {known.key}


def test_nothing_is_chosen_where_nothing_is_missing():
    step = stepwise(predictor_with((0.0, 0.0, 0.0), 0.0))
    assert step.models(5) == []
    assert step.exchanged() == []


def test_a_kind_that_stands_in_for_another_is_exchanged(predictor):
    stand_ins = tuple(PlacedEffect("load_friction", joint, (0.05,)) for joint in JOINTS)
    viscous = PlacedEffect("viscous_friction", "shoulder", (2.0,))
    step = stepwise(predictor, *stand_ins, viscous)
    proposed = step.exchanged()[:EXCHANGED]
    assert TRUE in [{placed.key for placed in model} for model in proposed]


def test_a_right_model_is_not_exchanged(predictor):
    true = (
        *(PlacedEffect("coulomb_friction", joint, (0.5,)) for joint in JOINTS),
        PlacedEffect("viscous_friction", "shoulder", (1.0,)),
    )
    step = stepwise(predictor, *true)
    proposed = step.exchanged()
    assert proposed
    for model in proposed:
        fit = fit_all(predictor, [model])[0]
        other = Judged(fit, fit.energy)
        assert not step.ebic.prefers(other, step.best)
