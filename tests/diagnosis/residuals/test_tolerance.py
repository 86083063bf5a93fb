"""What lies within a model's tolerance is no evidence; what lies beyond it is."""

import numpy as np
import pytest
from known_arms import CHANNELS, NOISE_RAD
from made_up_traces import arm, recorded
from scipy.stats import multivariate_normal

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.residuals.replays import tolerated
from diagnosis.residuals.tolerance import Tolerance


def test_the_energy_is_the_likelihood_of_noise_and_tolerances_together():
    random = np.random.default_rng(0)
    signatures, residual = random.standard_normal((3, 20)), random.standard_normal(20)
    covariance = np.eye(20) + signatures.T @ signatures
    (white,) = Tolerance(signatures).without(residual[None])
    exact = multivariate_normal(np.zeros(20), covariance)
    other = 2.5 * residual
    (whiter,) = Tolerance(signatures).without(other[None])
    wanted = exact.logpdf(residual) - exact.logpdf(other)
    assert 0.5 * (whiter @ whiter - white @ white) == pytest.approx(wanted)


def test_a_part_knows_its_own_share():
    random = np.random.default_rng(1)
    signatures, residual = random.standard_normal((2, 30)), random.standard_normal(30)
    own = np.arange(30) < 12
    part = Tolerance(signatures).part(own).without(residual[None, own])
    wanted = Tolerance(signatures[:, own]).without(residual[None, own])
    np.testing.assert_allclose(part, wanted)


def test_without_tolerances_all_stays():
    residual = np.ones((1, 5))
    np.testing.assert_array_equal(
        Tolerance(np.zeros((0, 5))).without(residual), residual
    )


def test_what_is_fitted_is_not_uncertain_as_well():
    random = np.random.default_rng(2)
    signatures, residual = random.standard_normal((3, 20)), random.standard_normal(20)
    every = Tolerance(signatures[:2], "ab").and_of(Tolerance(signatures[2:], "c"))
    some = every.scaled(2.0).part(np.full(20, True)).beside({"b", "d"})
    wanted = Tolerance(2.0 * signatures[[0, 2]]).without(residual[None])
    np.testing.assert_allclose(some.without(residual[None]), wanted)


def rms(*effects):
    """Rms [noise] of what the nominal arm leaves, with tolerances and without."""
    exact = Channels(CHANNELS.names, CHANNELS.noise / 20)
    trace = recorded(arm(), *effects, duration_s=3.0, noise_rad=NOISE_RAD / 20)
    predictor = Predictor(arm(), [trace], exact)
    predictor.calibrate()
    return [
        float(np.sqrt(np.mean(one.residuals([()])[0][one.scored] ** 2)))
        for one in (predictor, predictor.without_tolerances())
    ]


def test_a_heavier_link_within_its_tolerance_is_noise():
    """The lower link weighs 0.4 kg, known to 1 %."""
    with_it, without = rms(("payload_mass", "lower", 0.004))
    assert without > 1.2
    assert with_it < 1.05


def test_a_load_beyond_the_tolerance_is_seen():
    with_it, without = rms(("payload_mass", "lower", 0.08))
    assert without > 5
    assert with_it > 1.5


def test_missing_friction_is_never_within_tolerance():
    with_it, without = rms(("coulomb_friction", "elbow", 0.2))
    assert without > 5
    assert with_it > 0.3 * without


@pytest.mark.parametrize(("wrong", "wanted"), [(0.0, 0.0), (1.0, 1.0), (3.0, 3.0)])
def test_the_width_of_tolerances_is_seen_in_what_a_model_leaves(wrong, wanted):
    random = np.random.default_rng(2)
    signatures = 30 * random.standard_normal((40, 400)) / 20
    residual = random.standard_normal(400)
    residual += wrong * random.standard_normal(40) @ signatures
    found = Tolerance(signatures).likely_scale(residual)
    assert found == pytest.approx(wanted, rel=0.3, abs=0.1)


def test_pushes_and_limits_have_no_tolerance():
    names = {one.name for one in tolerated(arm(), ())}
    assert {"payload_mass", "com_offset", "armature", "encoder_offset"} <= names
    assert not names & {
        "external_force",
        "end_stop",
        "coulomb_friction",
        "torque_limit",
    }
    offset = [one.values for one in tolerated(arm(), ()) if one.name == "com_offset"]
    assert all(np.count_nonzero(values) == 1 for values in offset)
    assert PlacedEffect("encoder_offset", "elbow", (1e-3,)) in tolerated(arm(), ())
