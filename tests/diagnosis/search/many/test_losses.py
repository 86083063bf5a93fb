"""Linear estimates of what a fit loses with fewer values, against other fits."""

import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.fitting import fit_all
from diagnosis.search.many.losses import Losses

JOINTS = "yaw", "shoulder", "elbow"


def frictions(*sizes):
    each = zip(JOINTS, sizes, strict=True)
    return tuple(PlacedEffect("coulomb_friction", one, (size,)) for one, size in each)


@pytest.fixture(scope="module")
def predictor():
    rubs = rubbing((1.0, 1.0, 0.6), (0.0, 0.0, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found


@pytest.fixture(scope="module")
def fitted(predictor):
    return fit_all(predictor, [frictions(1.0, 1.0, 1.0)])[0]


def test_sharing_loses_what_another_fit_loses(predictor, fitted):
    found = list(Losses(fitted).sharing(arm()))
    pairs = [tuple(placed.place for placed in shared) for shared, _ in found]
    assert pairs == [("yaw", "shoulder"), ("yaw", "elbow"), ("shoulder", "elbow")]
    for shared, loss in found:
        keys = {placed.key for placed in shared}
        rest = [placed for placed in fitted.model if placed.key not in keys]
        lost = fit_all(predictor, [(*rest, *shared)])[0].energy - fitted.energy
        assert loss == pytest.approx(lost, rel=0.2, abs=0.5)
    # the elbow's friction is another one
    alike, *others = (loss for _, loss in found)
    assert alike < 0.01 * min(others)


def test_what_is_shared_has_the_mean_of_its_values(predictor):
    model = frictions(0.9, 0.9, 0.3)
    tied = tuple(
        PlacedEffect(one.name, one.place, one.values, tied="shoulder")
        for one in model[:2]
    )
    (fit,) = fit_all(predictor, [(*tied, model[2])], 1)
    ((shared, _),) = Losses(fit).sharing(arm())
    (value,) = {placed.values[0] for placed in shared}
    every = [placed.values[0] for placed in fit.model]
    assert value == pytest.approx(sum(every) / 3)
    assert {placed.tied for placed in shared} == {"elbow"}


def test_what_lasts_for_a_while_shares_nothing(predictor):
    off = [PlacedEffect("servo_off", joint, (0.2, 0.5, 1.0)) for joint in JOINTS[:2]]
    (fit,) = fit_all(predictor, [tuple(off)], 1)
    assert not list(Losses(fit).sharing(arm()))


def test_different_kinds_and_motors_share_nothing(predictor):
    dry, _, other = frictions(1.0, 1.0, 1.0)
    wet = PlacedEffect("viscous_friction", "shoulder", (0.1,))
    (fit,) = fit_all(predictor, [(dry, wet)])
    assert not list(Losses(fit).sharing(arm()))
    strong = arm()
    strong.spec.joint("elbow").armature = 0.3
    (fit,) = fit_all(predictor, [(dry, other)])
    assert list(Losses(fit).sharing(arm()))
    assert not list(Losses(fit).sharing(strong))
