"""Parts of the search for effects at all joints."""

import numpy as np
import pytest
from torque_arm import arm, moved, rubbing

from diagnosis.effects.parts import PlacedEffect
from diagnosis.residuals.signatures import signatures
from diagnosis.residuals.torque_evidence import with_motions
from diagnosis.residuals.torque_predictor import predictor_of
from diagnosis.search.everywhere import (
    apart,
    gains_of_each,
    kind_by_chance,
    more_is_missing,
)
from diagnosis.search.fitting import fit_all, ran_into_bound
from diagnosis.search.result import SearchResult
from diagnosis.search.screening import Screen
from diagnosis.traces.usage import Usage

MODEL = (
    PlacedEffect("coulomb_friction", "yaw", (0.5,)),
    PlacedEffect("viscous_friction", "shoulder", (1.0,)),
    PlacedEffect("payload_mass", "lower", (0.1,)),
)


@pytest.fixture(scope="module")
def predictor():
    rubs = rubbing((1.0, 0.0, 0.0), (0.0, 2.0, 0.0))
    found = predictor_of(arm(), with_motions(arm(), [moved(rubs)]))
    found.calibrate()
    return found


@pytest.fixture(scope="module")
def fitted(predictor):
    return fit_all(predictor, [MODEL], nudges_of=apart)[0]


def test_differences_together_are_those_one_by_one(predictor):
    together = fit_all(predictor, [MODEL], 1, nudges_of=apart)[0]
    alone = fit_all(predictor, [MODEL], 1)[0]
    np.testing.assert_allclose(together.energy, alone.energy, rtol=1e-3)
    first = alone.jacobian[:, 0]
    assert together.jacobian[:, 0] @ first > 0.95 * (first @ first)


def test_gains_are_what_removal_and_another_fit_cost(predictor, fitted):
    gains = gains_of_each(fitted)
    for i in range(2):
        rest = tuple(one for k, one in enumerate(fitted.model) if k != i)
        lost = fit_all(predictor, [rest])[0].energy - fitted.energy
        assert gains[i] == pytest.approx(lost, rel=0.2)
    # there is no payload
    assert gains[2] < 0.02 * min(gains[:2])


def test_more_is_missing_until_friction_is_known(predictor, fitted):
    nothing = SearchResult(1.0, 1.0, {}, 0)
    assert more_is_missing(predictor, nothing)
    known = predictor_of(arm(), with_motions(arm(), [moved()]))
    assert not more_is_missing(known, nothing)


def test_values_on_bounds_are_noticed(predictor, fitted):
    assert not any(ran_into_bound(fitted, one) for one in fitted.model[:2])
    far = (*fitted.model[:2], PlacedEffect("com_offset", "lower", (0.1, 0.0, 0.0)))
    stuck = fit_all(predictor, [far], 1)[0]
    stuck = type(stuck)(far, stuck.residual, stuck.jacobian, stuck.coordinates)
    assert ran_into_bound(stuck, far[2])
    assert not ran_into_bound(stuck, far[0])


def test_a_kind_gains_more_by_chance_than_one_effect(predictor):
    usage = Usage.of(predictor.plant, predictor.traces)
    found = signatures(predictor, (), usage, (), ("viscous_friction", "armature"))
    screen = Screen(predictor, found)
    noise = np.random.default_rng(0).standard_normal(len(predictor.scored))
    noise = noise * predictor.scored
    alone, kind = screen.gain_by_chance(noise), kind_by_chance(screen, noise)
    assert alone < kind < 3 * alone
    # three joints, of which a half gains nothing since friction has a sign
    assert 3.0 < kind < 12.0
