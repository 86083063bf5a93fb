"""Intervals of values that joints share."""

import numpy as np
import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.conclude.estimates import estimates, spread_of_joints
from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.ties import tied
from diagnosis.residuals.torques.torque_evidence import with_motions
from diagnosis.residuals.torques.torque_predictor import predictor_of
from diagnosis.search.fitting import fit_all

EACH = tuple(
    PlacedEffect("coulomb_friction", joint, (0.5,))
    for joint in ("yaw", "shoulder", "elbow")
)


def shared_fit(*coulomb_nm):
    rubs = rubbing(coulomb_nm, (0.0, 0.0, 0.0))
    predictor = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    predictor.calibrate()
    bare = predictor.nominal()
    return bare, fit_all(bare, [tied(arm(), EACH, "all")])[0]


def test_joints_that_differ_have_a_wide_interval():
    predictor, fit = shared_fit(0.6, 0.8, 1.0)
    torque = estimates(predictor, fit)[0]["torque"]
    (scaled,) = spread_of_joints(predictor, fit)
    size = fit.model[0].values[0] / fit.coordinates.of(fit.model)[0]
    wanted = np.sqrt(np.mean((np.array([0.6, 0.8, 1.0]) - torque.value) ** 2))
    assert scaled * size == pytest.approx(wanted, rel=0.15)
    assert torque.high - torque.low > 2 * wanted


def test_joints_that_are_alike_have_a_narrow_one():
    predictor, fit = shared_fit(0.8, 0.8, 0.8)
    torque = estimates(predictor, fit)[0]["torque"]
    assert torque.low < 0.8 < torque.high
    assert torque.high - torque.low < 0.1


def test_values_that_are_not_shared_have_no_spread():
    predictor, _ = shared_fit(0.6, 0.8, 1.0)
    (fit,) = fit_all(predictor, [EACH])
    assert not spread_of_joints(predictor, fit).any()
