"""What lies within a model's tolerance is no evidence; what lies beyond it is."""

import numpy as np
import pytest
from known_arms import CHANNELS, NOISE_RAD
from made_up_traces import arm, recorded
from scipy.stats import multivariate_normal

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.changes import Changes
from diagnosis.residuals.predictor import Channels, Predictor
from diagnosis.residuals.small_mismatch.usual_errors import usual_errors
from diagnosis.residuals.tolerance import Tolerance


def test_the_energy_is_the_likelihood_of_noise_and_tolerances_together():
    random = np.random.default_rng(0)
    signatures, residual = random.standard_normal((3, 20)), random.standard_normal(20)
    covariance = np.eye(20) + signatures.T @ signatures
    (white,) = Tolerance(Changes.of(signatures)).without(residual[None])
    exact = multivariate_normal(np.zeros(20), covariance)
    other = 2.5 * residual
    (whiter,) = Tolerance(Changes.of(signatures)).without(other[None])
    wanted = exact.logpdf(residual) - exact.logpdf(other)
    assert 0.5 * (whiter @ whiter - white @ white) == pytest.approx(wanted)


def test_a_part_knows_its_own_share():
    random = np.random.default_rng(1)
    signatures, residual = random.standard_normal((2, 30)), random.standard_normal(30)
    own = slice(12)
    part = Tolerance(Changes.of(signatures)).part(own).without(residual[None, own])
    wanted = Tolerance(Changes.of(signatures[:, own])).without(residual[None, own])
    np.testing.assert_allclose(part, wanted)


def test_without_tolerances_all_stays():
    residual = np.ones((1, 5))
    np.testing.assert_array_equal(
        Tolerance(Changes.of(np.zeros((0, 5)))).without(residual), residual
    )


def test_what_is_fitted_is_not_uncertain_as_well():
    random = np.random.default_rng(2)
    signatures, residual = random.standard_normal((3, 20)), random.standard_normal(20)
    every = Tolerance(Changes.of(signatures[:2]), "ab").and_of(
        Tolerance(Changes.of(signatures[2:]), "c")
    )
    some = every.part(slice(20)).beside({"b", "d"})
    wanted = Tolerance(Changes.of(signatures[[0, 2]])).without(residual[None])
    np.testing.assert_allclose(some.without(residual[None]), wanted)


def test_what_is_known_together_is_whitened_together():
    """One is fitted, of others the covariance is known, and one is independent."""
    random = np.random.default_rng(3)
    signatures, residual = random.standard_normal((4, 20)), random.standard_normal(20)
    root = random.standard_normal((3, 3))
    spread = root @ root.T
    known = Tolerance(Changes.of(signatures[:3]), "abc", spread=spread)
    every = known.and_of(Tolerance(Changes.of(signatures[3:]), "d")).beside({"b"})
    whole = np.zeros((3, 3))
    whole[:2, :2], whole[2, 2] = spread[np.ix_([0, 2], [0, 2])], 1.0
    some = signatures[[0, 2, 3]]
    covariance = np.eye(20) + some.T @ whole @ some
    (white,) = every.without(residual[None])
    assert white @ white == pytest.approx(
        residual @ np.linalg.solve(covariance, residual)
    )


def rms(*effects):
    """Rms [noise] of what the nominal arm leaves, with tolerances and without."""
    exact = Channels(CHANNELS.names, CHANNELS.noise / 20)
    trace = recorded(arm(), *effects, duration_s=3.0, noise_rad=NOISE_RAD / 20)
    predictor = Predictor(arm(), [trace], exact)
    predictor.calibrate()
    return [
        float(np.sqrt(np.mean(one.residuals([()])[0][one.scored] ** 2)))
        for one in (predictor, predictor.nominal())
    ]


@pytest.mark.parametrize(
    ("usual", "unusual"),
    [
        (("payload_mass", "lower", 0.016), ("payload_mass", "lower", 0.2)),
        (("coulomb_friction", "elbow", 0.02), ("coulomb_friction", "elbow", 0.2)),
        (("servo_gain", "elbow", 0.94), ("servo_gain", "elbow", 0.8)),
    ],
)
def test_what_models_usually_get_wrong_is_noise_and_more_is_not(usual, unusual):
    """The lower link weighs 0.4 kg, known to 2 %; a servo's stiffness to 3 %."""
    with_it, without = rms(usual)
    assert without > 10
    assert with_it < 1.05
    assert rms(unusual)[0] > 1.5


def test_pushes_and_limits_have_no_tolerance():
    names = {one.name for one in usual_errors(arm(), ())}
    assert {"payload_mass", "com_offset", "armature", "encoder_offset"} <= names
    assert not names & {
        "external_force",
        "end_stop",
        "torque_limit",
    }
    offset = [one.values for one in usual_errors(arm(), ()) if one.name == "com_offset"]
    assert all(np.count_nonzero(values) == 1 for values in offset)
    assert PlacedEffect("encoder_offset", "elbow", (1e-3,)) in usual_errors(arm(), ())


def test_a_spread_that_is_singular_to_rounding_is_no_error():
    """What a reference tells very well has a variance below rounding errors."""
    random = np.random.default_rng(4)
    changes, seen = random.standard_normal((3, 20)), np.array([[1.0, 1.0, 0.0]])
    spread = np.eye(3) - (1 + 1e-15) * seen.T @ seen / 2
    found = Tolerance(Changes.of(changes), spread=spread).without(
        random.standard_normal((2, 20))
    )
    assert np.isfinite(found).all()
